//! The errors of one flight, and what the filter reports of them.

use crate::figure::{self, Draw, ESTIMATED, Figure, INK, decimals, letters_right_of};
use crate::msckf::flights::{Seen, minute};

/// Every so many pictures are shown.
const EVERY: usize = 12;

pub fn flight() -> Figure {
    let (_, seen) = minute();
    let shown: Vec<Seen> = seen.into_iter().step_by(EVERY).collect();
    let of = |value: fn(&Seen) -> f64| shown.iter().map(value);
    let seconds = || (0..shown.len()).map(|at| (at * EVERY) as f64 / 10.0);
    let [error, sigma]: [fn(&Seen) -> f64; 2] =
        [|seen| 100.0 * seen.error, |seen| 100.0 * seen.sigma];
    let [yaw_error, yaw]: [fn(&Seen) -> f64; 2] =
        [|seen| 1e3 * seen.yaw_error, |seen| 1e3 * seen.yaw];
    let columns = vec![
        ("time (s)", decimals(1, seconds())),
        ("position error (cm)", decimals(2, of(error))),
        ("reported σ of the position (cm)", decimals(2, of(sigma))),
        ("yaw error (mrad)", decimals(2, of(yaw_error))),
        ("reported σ of the yaw (mrad)", decimals(2, of(yaw))),
    ];
    Figure::new(1100, columns, |drawing| {
        let panels = [("position (cm)", error, sigma, 0.0), ("yaw (mrad)", yaw_error, yaw, -1.0)];
        for (half, (title, error, sigma, least)) in drawing.split_evenly((2, 1)).iter().zip(panels)
        {
            let highest = of(error).map(f64::abs).chain(of(sigma)).fold(0.0, f64::max);
            let y_axis = (title, least * 1.1 * highest..1.1 * highest, 5);
            let mut chart = figure::axes(half, ("time (s)", 0.0..60.0, 7), y_axis)?;
            chart.line(seconds().zip(of(sigma)), ESTIMATED, 5)?;
            if least < 0.0 {
                chart.line(seconds().zip(of(sigma).map(|sigma| -sigma)), ESTIMATED, 5)?;
            }
            chart.line(seconds().zip(of(error)), INK, 4)?;
            chart.write("reported σ", (2.0, 0.98 * highest), letters_right_of(ESTIMATED))?;
            chart.write("error", (14.0, 0.98 * highest), letters_right_of(INK))?;
        }
        Ok(())
    })
}
