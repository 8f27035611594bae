//! How much too sure a covariance is of an attitude whose noise has a memory.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, geometric, letters_right_of};
use crate::preintegration::noise::correlated::{attitude_runs, too_sure};
use crate::preintegration::noise::runs::DT;

/// Seconds over which the noise forgets.
const MEMORIES: [f64; 3] = [0.05, 0.02, 0.005];
const READINGS: [usize; 8] = [1, 3, 7, 16, 36, 84, 200, 400];
const RUNS: usize = 600;

pub fn correlated() -> Figure {
    let runs = MEMORIES.map(|memory| attitude_runs(memory, &READINGS, RUNS));
    let formula = |index: usize| decimals(2, READINGS.map(|n| too_sure(n, MEMORIES[index])));
    let in_runs = |index: usize| decimals(2, runs[index].clone());
    let columns = vec![
        ("time (s)", decimals(3, READINGS.map(|n| n as f64 * DT))),
        ("actual over predicted with a memory of 50 ms", formula(0)),
        ("in runs", in_runs(0)),
        ("with 20 ms", formula(1)),
        ("in runs", in_runs(1)),
        ("with 5 ms", formula(2)),
        ("in runs", in_runs(2)),
    ];
    Figure::new(760, columns, |drawing| {
        let x_axis = ("time (s)", (0.004..7.0).log_scale(), 4);
        let mut chart = figure::axes(drawing, x_axis, ("actual / predicted", 0.0..5.0, 6))?;
        chart.line([(0.004, 1.0), (2.3, 1.0)], INK, 4)?;
        chart.write("white", (2.6, 0.98), letters_right_of(INK))?;
        for (index, memory) in MEMORIES.into_iter().enumerate() {
            let curve = geometric(1.0, 400.0, 80).map(f64::round);
            chart.line(curve.map(|n| (n * DT, too_sure(n as usize, memory))), SERIES[index], 5)?;
            let places = READINGS.iter().zip(&runs[index]);
            chart.marks(places.map(|(n, ratio)| (*n as f64 * DT, *ratio)), index)?;
            let (name, beside) = (format!("{} ms", 1e3 * memory), (2.6, too_sure(400, memory)));
            chart.write(&name, beside, letters_right_of(SERIES[index]))?;
        }
        Ok(())
    })
}
