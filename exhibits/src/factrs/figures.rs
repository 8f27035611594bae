//! Errors of the turn over the seeds.

use super::errors::{QUANTILES, SEEDS, ours, quantiles};
use crate::chapter::Chapter;
use crate::figure::{self, Draw, Figure, GRID, INK, SERIES, decimals, letters_right_of};
use crate::random::Random;
use crate::record::accepted;

/// Draws of an error that is as large as the bound says.
const DRAWS: usize = 4000;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("seeds", seeds);
}

/// What the errors would be if each coordinate had its part of the bound.
fn expected() -> Vec<f64> {
    let bound = &ours().bound;
    let mean = bound.iter().map(|bound| bound[0]).sum::<f64>() / SEEDS as f64;
    let mut random = Random::new(74);
    let mut square = || random.normal((mean / 3.0).sqrt()).powi(2);
    let draws: Vec<_> =
        (0..DRAWS).map(|_| [square() + square() + square(), 0.0, 0.0, 0.0]).collect();
    quantiles(&draws)
}

fn seeds() -> Figure {
    let share: Vec<f64> =
        (0..QUANTILES).map(|k| 100.0 * (k as f64 + 0.5) / QUANTILES as f64).collect();
    let named: Vec<f64> =
        (0..QUANTILES).map(|k| accepted("factrs_seeds", &format!("named_turn_{k}"))).collect();
    let (expected, huber) = (expected(), quantiles(&ours().huber));
    let columns = vec![
        ("share of the seeds (%)", decimals(1, share.clone())),
        ("the bound (mrad)", decimals(2, expected.clone())),
        ("ours, and factrs with our factors (mrad)", decimals(2, huber.clone())),
        ("factrs with cov_gyro set (mrad)", decimals(2, named.clone())),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("error of the turn (mrad)", 0.0..18.0, 7);
        let mut chart = figure::axes(drawing, x_axis, ("share of the seeds (%)", 0.0..100.0, 6))?;
        let along = |errors: &[f64]| errors.iter().copied().zip(share.clone()).collect::<Vec<_>>();
        chart.line(along(&expected), GRID, 12)?;
        let curves =
            [("ours, and factrs with our factors", &huber), ("factrs with cov_gyro set", &named)];
        for (series, (name, errors)) in curves.into_iter().enumerate() {
            chart.line(along(errors), SERIES[series], 3)?;
            chart.marks(along(errors), series)?;
            chart.key(series, name, (7.2, 28.0 - 10.0 * series as f64), 7.6)?;
        }
        chart.line([(6.8, 8.0), (7.4, 8.0)], GRID, 12)?;
        chart.write("the Cramér-Rao bound", (7.6, 8.0), letters_right_of(INK))
    })
}
