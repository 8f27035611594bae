//! By how much small motions move a pixel, over the depth of its point.

use nalgebra::{Isometry3, Vector3};
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, letters_right_of, marker};
use crate::reprojection::NO_POSE_BLOCK;
use crate::reprojection::worked::{CAMERA, POINT};

/// Metres along the optical axis.
const DEPTHS: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

const MILLIRADIAN: f64 = 1e-3;
const CENTIMETRE: f64 = 1e-2;

pub fn sensitivity() -> Figure {
    let rows = DEPTHS.map(|depth| {
        let mut row = vec![format!("{depth}")];
        row.extend(moves(depth).map(|pixels| format!("{pixels:.5}")));
        row
    });
    Figure {
        columns: vec![
            "depth (m)",
            "a milliradian about y (px)",
            "a centimetre to the side (px)",
            "a centimetre forward at the worked bearing (px)",
            "a centimetre forward at the worked offset (px)",
        ],
        rows: rows.to_vec(),
        svg: draw(),
    }
}

/// Columns by which the pixel moves for each of the four motions.
fn moves(depth: f64) -> [f64; 4] {
    let along_bearing = (depth / POINT.z) * POINT;
    let at_offset = Vector3::new(POINT.x, POINT.y, depth);
    let column = |point: &Vector3<f64>, index: usize| {
        let blocks = CAMERA.jacobians(&Isometry3::identity(), point);
        blocks.map_or(NO_POSE_BLOCK, |both| both.0)[(0, index)].abs()
    };
    [
        MILLIRADIAN * column(&along_bearing, 4),
        CENTIMETRE * column(&along_bearing, 0),
        CENTIMETRE * column(&along_bearing, 2),
        CENTIMETRE * column(&at_offset, 2),
    ]
}

fn draw() -> String {
    let names = ["a milliradian", "1 cm sideways", "1 cm forward,", "1 cm forward,"];
    let second_lines = ["", "", "same bearing", "same offset"];
    figure::draw(900, |drawing| {
        let x_axis = ("depth (m)", (0.9..520.0).log_scale(), 3);
        let y_axis = ("move of the column (px)", (0.0001..10.0).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for index in 0..4 {
            let line = DEPTHS.map(|depth| (depth, moves(depth)[index]));
            let colour = SERIES[index];
            chart.draw_series(LineSeries::new(line, colour.stroke_width(5)))?;
            chart.draw_series(line.map(|place| EmptyElement::at(place) + marker(index)))?;
            let (x, y) = line[DEPTHS.len() - 1];
            let first = Text::new(names[index], (1.12 * x, y), letters_right_of(colour));
            chart.draw_series([first])?;
            let below = (1.12 * x, y / 1.7);
            chart.draw_series([Text::new(second_lines[index], below, letters_right_of(colour))])?;
        }
        Ok(())
    })
}
