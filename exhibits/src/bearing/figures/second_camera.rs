//! How loudly the second camera objects to a wrong depth.

use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::bearing::stretch_shift;

use crate::bearing::worked::{CAMERA, POINT};
use crate::figure::{
    self, Draw, Figure, GRID, INK, SERIES, decimals, letters_around, letters_right_of,
};

/// Metres between the cameras.
const BASELINES: [f64; 4] = [0.1, 0.25, 0.5, 1.0];

pub fn second_camera() -> Figure {
    let errors = || (-4..=12).map(|quarter| f64::from(quarter) / 4.0);
    let at = |baseline| decimals(2, errors().map(|error| pixel_error(baseline, error)));
    let columns = vec![
        ("depth error (m)", decimals(2, errors())),
        ("pixel error at 0.1 m baseline (px)", at(BASELINES[0])),
        ("at 0.25 m (px)", at(BASELINES[1])),
        ("at 0.5 m (px)", at(BASELINES[2])),
        ("at 1 m (px)", at(BASELINES[3])),
    ];
    Figure::new(860, columns, |drawing| {
        let x_axis = ("error of the assumed depth (m)", -1.15..3.85, 6);
        let y_axis = ("error in image 1 (px)", -24.0..33.0, 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.draw_series([Rectangle::new([(-1.15, -1.0), (3.85, 1.0)], GRID.filled())])?;
        chart.write("one pixel", (3.35, -3.2), letters_around(INK))?;
        chart.line([(-1.15, 0.0), (3.85, 0.0)], INK, 2)?;
        chart.line([(0.0, -24.0), (0.0, 33.0)], INK, 2)?;
        for (index, baseline) in BASELINES.into_iter().enumerate() {
            let at = |error: f64| (error, pixel_error(baseline, error));
            chart.line((-20..=60).map(|step| at(f64::from(step) / 20.0)), SERIES[index], 5)?;
            chart.marks((-1..=3).map(|metre| at(f64::from(metre))), index)?;
            let beside = (3.12, at(3.0).1);
            chart.write(&format!("{baseline} m"), beside, letters_right_of(SERIES[index]))?;
        }
        Ok(())
    })
}

/// Pixels by which the second camera's pixel lies too far to the right.
fn pixel_error(baseline: f64, depth_error: f64) -> f64 {
    stretch_shift(&CAMERA, baseline, POINT.z, (POINT.z + depth_error) / POINT.z)
}
