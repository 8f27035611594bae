//! What waiting is worth on a line, by the noise of a step.

use crate::figure::{self, Draw, Figure, SERIES, decimals, letters_right_of};
use crate::smoother::lag::{delayed, filtered};

const MOST: usize = 25;
/// Standard deviations of a step, over that of a measurement.
const STEPS: [f64; 3] = [0.03, 0.1, 0.3];

pub fn lag() -> Figure {
    let curve = |step: f64| {
        let now = filtered(step * step, 1.0);
        (0..=MOST).map(move |lag| (delayed(now, step * step, lag) / now).sqrt())
    };
    let mut columns = vec![("steps of delay", (0..=MOST).map(|lag| lag.to_string()).collect())];
    let titles = ["step of .03", "step of .1", "step of .3"];
    columns
        .extend(titles.iter().zip(STEPS).map(|(title, step)| (*title, decimals(3, curve(step)))));
    Figure::new(760, columns, |drawing| {
        let y_axis = ("part of the filter's σ", 0.6..1.05, 5);
        let mut chart = figure::axes(drawing, ("steps of delay", 0.0..MOST as f64, 6), y_axis)?;
        for (series, (step, title)) in STEPS.into_iter().zip(titles).enumerate() {
            let points = || (0..).map(f64::from).zip(curve(step));
            chart.line(points(), SERIES[series], 4)?;
            chart.marks(points().step_by(3 + series), series)?;
            let height = 1.02 - 0.035 * series as f64;
            chart.key(series, title, (14.0, height), 14.6)?;
        }
        let half = std::f64::consts::FRAC_1_SQRT_2;
        chart.line([(0.0, half), (MOST as f64, half)], figure::INK, 2)?;
        chart.write("half of the variance", (0.5, half - 0.02), letters_right_of(figure::INK))
    })
}
