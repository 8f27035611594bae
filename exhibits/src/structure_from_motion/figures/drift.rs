//! How far each camera of the street is off.

use crate::figure::{self, Draw, Figure, decimals, plain};
use crate::structure_from_motion::street::{ADJUSTMENTS, shown};

/// Below this the drawing ends, in metres.
const LEAST: f64 = 1e-3;

pub fn drift() -> Figure {
    let off = &shown().off;
    let mut columns = vec![("camera", plain(0..off[0].len()))];
    let titles = ["no adjustment (m)", "near cameras (m)", "near ones, and all (m)"];
    columns.extend(
        titles.into_iter().zip(off).map(|(title, off)| (title, decimals(3, off.iter().copied()))),
    );
    Figure::new(820, columns, |drawing| {
        let axes = [
            ("camera", 0.0..40.0, 9),
            ("log\u{2081}\u{2080} of the error in metres", -3.0..2.0, 6),
        ];
        let [x_axis, y_axis] = axes;
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (way, off) in off.iter().enumerate() {
            let points: Vec<(f64, f64)> = off
                .iter()
                .enumerate()
                .skip(1)
                .map(|(camera, off)| (camera as f64, off.max(LEAST).log10()))
                .collect();
            chart.line(points.iter().copied(), figure::SERIES[way], 4)?;
            chart.marks(points.into_iter().step_by(4), way)?;
            let y = 1.7 - 0.35 * way as f64;
            chart.key(way, ADJUSTMENTS[way].0, (1.0, y), 2.0)?;
        }
        Ok(())
    })
}
