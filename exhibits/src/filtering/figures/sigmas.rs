//! What is believed of position and yaw while the light goes out.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_right_of};
use crate::filtering::numbers::{DARK, SECONDS, darkened};

pub fn sigmas() -> Figure {
    let [moments, often] = darkened();
    let seconds = || moments.iter().map(|moment| moment.seconds);
    let sigma = |at: usize| moments.iter().map(move |moment| moment.sigmas[at]);
    let errors = [
        moments.iter().map(|moment| moment.error.yaw().abs()).collect::<Vec<_>>(),
        moments.iter().map(|moment| moment.error.position.x.abs()).collect(),
    ];
    let iterated = [
        often.iter().map(|moment| moment.error.yaw().abs()).collect::<Vec<_>>(),
        often.iter().map(|moment| moment.error.position.x.abs()).collect(),
    ];
    // The table has every fourth picture.
    let milli = |values: Vec<f64>| decimals(2, values.into_iter().step_by(4).map(|v| 1e3 * v));
    let columns = vec![
        ("time (s)", decimals(1, seconds().step_by(4))),
        ("sigma of the yaw (mrad)", milli(sigma(0).collect())),
        ("error of the yaw (mrad)", milli(errors[0].clone())),
        ("sigma of x (mm)", milli(sigma(1).collect())),
        ("error of x (mm)", milli(errors[1].clone())),
        ("error of the yaw, iterated (mrad)", milli(iterated[0].clone())),
        ("error of x, iterated (mm)", milli(iterated[1].clone())),
    ];
    Figure::new(1240, columns, |drawing| {
        let titles = ["yaw (mrad)", "x (mm)"];
        let ranges = [0.3..60.0, 1.0..3e3];
        for (at, half) in drawing.split_evenly((2, 1)).iter().enumerate() {
            let y_axis = (titles[at], ranges[at].clone().log_scale(), 4);
            let mut chart = figure::axes(half, ("time (s)", 0.0..SECONDS, 6), y_axis)?;
            for edge in DARK {
                chart.line([(edge, ranges[at].start), (edge, ranges[at].end)], INK, 2)?;
            }
            let at_text = (DARK[0] + 0.3, ranges[at].end * 0.6);
            chart.write("dark", at_text, letters_right_of(INK))?;
            let least = ranges[at].start;
            let error = seconds().zip(errors[at].iter().map(|e| (1e3 * e).max(least)));
            chart.line(error, SERIES[1], 3)?;
            let again = seconds().zip(iterated[at].iter().map(|e| (1e3 * e).max(least)));
            chart.line(again.filter(|(second, _)| *second >= DARK[1]), SERIES[2], 4)?;
            chart.line(seconds().zip(sigma(at).map(|s| 1e3 * s)), SERIES[0], 6)?;
        }
        Ok(())
    })
}
