//! How loudly the second camera objects to a wrong depth.

use plotters::element::{EmptyElement, PathElement, Rectangle, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::bearing::stretch_shift;

use crate::bearing::worked::{CAMERA, POINT};
use crate::figure::{self, Figure, GRID, INK, SERIES, letters_around, letters_right_of, marker};

/// Metres between the cameras.
const BASELINES: [f64; 4] = [0.1, 0.25, 0.5, 1.0];

pub fn second_camera() -> Figure {
    let rows = (-4..=12).map(|quarter| {
        let depth_error = f64::from(quarter) / 4.0;
        let pixel_errors = BASELINES.map(|baseline| pixel_error(baseline, depth_error));
        let mut row = vec![format!("{depth_error:.2}")];
        row.extend(pixel_errors.map(|error| format!("{error:.2}")));
        row
    });
    Figure {
        columns: vec![
            "depth error (m)",
            "pixel error at 0.1 m baseline (px)",
            "at 0.25 m (px)",
            "at 0.5 m (px)",
            "at 1 m (px)",
        ],
        rows: rows.collect(),
        svg: draw(),
    }
}

/// Pixels by which the second camera's pixel lies too far to the right.
fn pixel_error(baseline: f64, depth_error: f64) -> f64 {
    stretch_shift(&CAMERA, baseline, POINT.z, (POINT.z + depth_error) / POINT.z)
}

fn draw() -> String {
    figure::draw(860, |drawing| {
        let x_axis = ("error of the assumed depth (m)", -1.15..3.85, 6);
        let y_axis = ("error in image 1 (px)", -24.0..33.0, 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        let one_pixel = Rectangle::new([(-1.15, -1.0), (3.85, 1.0)], GRID.filled());
        chart.draw_series([one_pixel])?;
        let band_name = Text::new("one pixel", (3.35, -3.2), letters_around(INK));
        chart.draw_series([band_name])?;
        for zero in [vec![(-1.15, 0.0), (3.85, 0.0)], vec![(0.0, -24.0), (0.0, 33.0)]] {
            chart.draw_series([PathElement::new(zero, INK.stroke_width(2))])?;
        }
        for (index, baseline) in BASELINES.into_iter().enumerate() {
            let at = |error: f64| (error, pixel_error(baseline, error));
            let curve = (-20..=60).map(|step| at(f64::from(step) / 20.0));
            chart.draw_series(LineSeries::new(curve, SERIES[index].stroke_width(5)))?;
            chart.draw_series(
                (-1..=3).map(|metre| EmptyElement::at(at(f64::from(metre))) + marker(index)),
            )?;
            let (end, height) = at(3.0);
            let name = format!("{baseline} m");
            let beside = (end + 0.12, height);
            chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
        }
        Ok(())
    })
}
