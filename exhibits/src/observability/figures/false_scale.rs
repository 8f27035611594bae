//! Which strength of gravity a constant acceleration asks for at another scale.

use nalgebra::Vector3;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::GRAVITY;

use crate::figure::{self, Figure, INK, SERIES, letters_right_of, marker};
use crate::observability::numbers::RAMP;
use crate::observability::readings::other_scale;

const NAMES: [&str; 3] = ["on a level road", "uphill", "downhill"];
const SCALES: [f64; 2] = [-0.4, 2.6];

fn accelerations() -> [Vector3<f64>; 3] {
    let along = |up: f64| Vector3::new(RAMP.x, RAMP.y, up);
    [along(0.0), along(RAMP.z), along(-RAMP.z)]
}

/// By how much gravity would have to be stronger than it is, in m/s².
fn excess(acceleration: &Vector3<f64>, scale: f64) -> f64 {
    (GRAVITY + (scale - 1.0) * acceleration).norm() - GRAVITY.norm()
}

fn curve(acceleration: &Vector3<f64>, steps: u32) -> Vec<(f64, f64)> {
    let at = |step: u32| SCALES[0] + (SCALES[1] - SCALES[0]) * f64::from(step) / f64::from(steps);
    (0..=steps).map(|step| (at(step), excess(acceleration, at(step)))).collect()
}

pub fn false_scale() -> Figure {
    let curves = accelerations().map(|acceleration| curve(&acceleration, 15));
    let rows = (0..curves[0].len()).map(|row| {
        let mut cells = vec![format!("{:.1}", curves[0][row].0)];
        cells.extend(curves.iter().map(|curve| format!("{:.3}", curve[row].1)));
        cells
    });
    Figure {
        columns: vec![
            "scale",
            "excess of gravity on a level road (m/s²)",
            "uphill (m/s²)",
            "downhill (m/s²)",
        ],
        rows: rows.collect(),
        svg: figure::draw(820, |drawing| {
            let x_axis = ("scale", SCALES[0]..SCALES[1], 7);
            let y_axis = ("excess of gravity (m/s²)", -0.25..0.95, 6);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            let zero = [(SCALES[0], 0.0), (SCALES[1], 0.0)];
            chart.draw_series([PathElement::new(zero, INK.stroke_width(3))])?;
            for (index, acceleration) in accelerations().iter().enumerate() {
                let line = LineSeries::new(curve(acceleration, 90), SERIES[index].stroke_width(5));
                chart.draw_series(line)?;
                let root = other_scale(acceleration, &GRAVITY);
                chart.draw_series([EmptyElement::at((root, 0.0)) + marker(index)])?;
                let place = (0.35, 0.88 - 0.1 * index as f64);
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let beside = (place.0 + 0.06, place.1);
                let name = Text::new(NAMES[index], beside, letters_right_of(SERIES[index]));
                chart.draw_series([name])?;
            }
            Ok(())
        }),
    }
}
