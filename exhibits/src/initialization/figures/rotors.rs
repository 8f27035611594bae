//! Readings and pictures of a body that stands with its rotors running, and takes off.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_right_of};
use crate::initialization::real::{HALVES, accepted_value};

/// When the body takes off, in seconds.
const TAKE_OFF: f64 = 4.9;

/// A value of each half second, at its middle.
fn of(name: &str) -> Vec<(f64, f64)> {
    let value = |at: usize| (0.5 * at as f64 + 0.25, accepted_value(&format!("{name}_{at}")));
    (0..HALVES).map(value).collect()
}

pub fn rotors() -> Figure {
    let (scatter, motion) = (of("rest_scatter"), of("rest_motion"));
    let cells = |of: &[(f64, f64)]| decimals(2, of.iter().map(|(_, value)| *value));
    let columns = vec![
        ("time (s)", decimals(2, scatter.iter().map(|(time, _)| *time))),
        ("scatter of the accelerometer's length (m/s²)", cells(&scatter)),
        ("motion of half of the features in half a second (px)", cells(&motion)),
    ];
    Figure::new(1100, columns, |drawing| {
        let [above, below] = [0, 1].map(|half| drawing.split_evenly((2, 1))[half].clone());
        let highest = scatter.iter().map(|(_, value)| *value).fold(0.0, f64::max);
        let y_axis = ("scatter (m/s²)", 0.0..1.2 * highest, 5);
        let mut chart = figure::axes(&above, ("", 0.0..8.0, 9), y_axis)?;
        chart.line([(TAKE_OFF, 0.0), (TAKE_OFF, 1.2 * highest)], INK, 3)?;
        chart.write("takes off", (TAKE_OFF + 0.1, 0.08 * highest), letters_right_of(INK))?;
        chart.line(scatter.iter().copied(), SERIES[0], 4)?;
        chart.marks(scatter.iter().copied(), 0)?;
        chart.key(0, "accelerometer", (0.3, 1.08 * highest), 0.5)?;
        let y_axis = ("motion (px)", (0.03..300.0).log_scale(), 5);
        let mut chart = figure::axes(&below, ("time (s)", 0.0..8.0, 9), y_axis)?;
        chart.line([(TAKE_OFF, 0.03), (TAKE_OFF, 300.0)], INK, 3)?;
        chart.line(motion.iter().copied(), SERIES[1], 4)?;
        chart.marks(motion.iter().copied(), 1)?;
        chart.key(1, "pictures", (0.3, 120.0), 0.5)?;
        Ok(())
    })
}
