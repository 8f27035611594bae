//! A minute of hovering, with a word about rest and without.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, powers};
use crate::msckf::flights::{Seen, hovers};

const NAMES: [&str; 2] = ["pictures alone", "told that it rests"];
/// Every so many pictures are shown.
const EVERY: usize = 20;

pub fn hover() -> Figure {
    let hovers = hovers();
    let shown =
        hovers.each_ref().map(|seen| seen.iter().step_by(EVERY).copied().collect::<Vec<_>>());
    let time = |at: usize| (at * EVERY) as f64 / 10.0;
    let of = |which: usize, value: fn(&Seen) -> f64| powers(2, shown[which].iter().map(value));
    let columns = vec![
        ("time (s)", decimals(0, (0..shown[0].len()).map(time))),
        ("error with pictures alone (m)", of(0, |seen| seen.error)),
        ("believed, pictures alone (m)", of(0, |seen| seen.sigma)),
        ("error when told (m)", of(1, |seen| seen.error)),
        ("believed when told (m)", of(1, |seen| seen.sigma)),
    ];
    Figure::new(820, columns, |drawing| {
        let x_axis = ("time (s)", 0.0..60.0, 7);
        let y_axis = ("position (m)", (5e-4..2e3).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, seen) in shown.iter().enumerate() {
            let line = |value: fn(&Seen) -> f64| {
                seen.iter().enumerate().skip(1).map(move |(at, seen)| (time(at), value(seen)))
            };
            chart.line(line(|seen| seen.sigma), SERIES[index], 3)?;
            chart.marks(line(|seen| seen.error), index)?;
            chart.key(index, NAMES[index], (3.0, [700.0, 180.0][index]), 4.5)?;
        }
        Ok(())
    })
}
