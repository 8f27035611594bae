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
    let columns = vec![
        ("time (s)", decimals(1, seconds())),
        ("sigma of the yaw (mrad)", decimals(2, sigma(0).map(|s| 1e3 * s))),
        ("error of the yaw (mrad)", decimals(2, errors[0].iter().map(|e| 1e3 * e))),
        ("sigma of x (mm)", decimals(2, sigma(1).map(|s| 1e3 * s))),
        ("error of x (mm)", decimals(2, errors[1].iter().map(|e| 1e3 * e))),
        ("error of the yaw, iterated (mrad)", decimals(2, iterated[0].iter().map(|e| 1e3 * e))),
        ("error of x, iterated (mm)", decimals(2, iterated[1].iter().map(|e| 1e3 * e))),
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
