//! How badly a scale fits, for four motions.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, geometric, powers};
use crate::initialization::motions::{equations, misfit, motions};

const SECONDS: f64 = 2.0;
/// What fits better is shown here, in millimetres.
const LEAST: f64 = 1e-3;

fn scales() -> impl Iterator<Item = f64> + Clone {
    geometric(0.2, 100.0, 4000)
}

pub fn minima() -> Figure {
    let curves = motions().map(|(name, motion)| {
        let equations = equations(motion, SECONDS);
        let misfits = scales().map(|scale| (1e3 * misfit(&equations, scale)).max(LEAST));
        (name, misfits.collect::<Vec<f64>>())
    });
    let cells = |which: usize| powers(1, curves[which].1.iter().copied().step_by(100));
    let columns = vec![
        ("scale over the true one", decimals(2, scales().step_by(100))),
        ("figure-eight (mm)", cells(0)),
        ("constant acceleration; rising (mm)", cells(1)),
        ("constant acceleration; level (mm)", cells(2)),
        ("constant velocity (mm)", cells(3)),
    ];
    Figure::new(1000, columns, |drawing| {
        let x_axis = ("scale, over the true one", (0.2..20.0).log_scale(), 6);
        let y_axis = ("least misfit (mm)", (0.5 * LEAST..9e5).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (series, (name, misfits)) in curves.iter().enumerate() {
            let points: Vec<(f64, f64)> = scales().zip(misfits.iter().copied()).collect();
            chart.line(points.iter().copied(), SERIES[series], 4)?;
            chart.marks(points.into_iter().skip(100 + 100 * series).step_by(400), series)?;
            chart.key(series, name, (0.24, 4e5 / 5.0_f64.powi(series as i32)), 0.27)?;
        }
        Ok(())
    })
}
