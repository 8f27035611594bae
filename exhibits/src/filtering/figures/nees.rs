//! Normalized errors of many flights over time.

use crate::figure::{self, Draw, Figure, GRID, INK, SERIES, decimals, letters_right_of};
use crate::filtering::numbers::{LIVE_RUNS, LIVE_SECONDS, live, mean_band, run_band};

/// Runs that are drawn.
const DRAWN: usize = 4;

pub fn nees() -> Figure {
    let runs = live();
    let seconds: Vec<f64> = runs[0].iter().map(|moment| moment.seconds).collect();
    let mean: Vec<f64> = (0..seconds.len())
        .map(|at| runs.iter().map(|run| run[at].whole).sum::<f64>() / LIVE_RUNS as f64)
        .collect();
    let band = mean_band();
    let columns = vec![
        ("time (s)", decimals(1, seconds.iter().copied().step_by(3))),
        ("mean of all flights", decimals(2, mean.iter().copied().step_by(3))),
        ("first flight", decimals(2, runs[0].iter().step_by(3).map(|moment| moment.whole))),
        ("second flight", decimals(2, runs[1].iter().step_by(3).map(|moment| moment.whole))),
    ];
    Figure::new(940, columns, |drawing| {
        let x_axis = ("time (s)", 0.0..LIVE_SECONDS, 6);
        let mut chart = figure::axes(drawing, x_axis, ("NEES", 0.0..2.8, 5))?;
        for run in &runs[..DRAWN] {
            chart.line(run.iter().map(|moment| (moment.seconds, moment.whole)), GRID, 3)?;
        }
        for end in run_band() {
            chart.line([(0.0, end), (LIVE_SECONDS, end)], SERIES[1], 3)?;
        }
        for end in [band.low, band.high] {
            chart.line([(0.0, end), (LIVE_SECONDS, end)], INK, 4)?;
        }
        chart.line(seconds.iter().copied().zip(mean), SERIES[0], 6)?;
        chart.write("one flight", (0.3, run_band()[1] + 0.14), letters_right_of(SERIES[1]))?;
        chart.write("mean", (0.3, band.high + 0.13), letters_right_of(INK))?;
        Ok(())
    })
}
