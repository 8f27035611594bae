//! Pixel error over the offset between two clocks, before and after a first-order correction.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, plain};
use crate::inertial::clock::{DEPTH, PACES, expected_error, offset_error, paced};

/// Milliseconds.
const OFFSETS: [f64; 7] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

/// Which pace, and whether corrected; and where the name stands.
const CASES: [(usize, bool, &str, (f64, f64)); 4] = [
    (1, false, "fast", (0.42, 3.5e2)),
    (0, false, "slow", (0.42, 3.5e2 / 4.0)),
    (1, true, "fast, corrected", (5.0, 1.5e-4)),
    (0, true, "slow, corrected", (5.0, 3e-5)),
];

pub fn offset() -> Figure {
    let motions = PACES.map(paced);
    let found = CASES.map(|(pace, corrected, ..)| {
        OFFSETS.map(|ms| offset_error(&motions[pace], DEPTH, 1e-3 * ms, corrected))
    });
    let columns = vec![
        ("offset (ms)", plain(OFFSETS)),
        ("fast (px)", decimals(5, found[0])),
        ("slow (px)", decimals(5, found[1])),
        ("fast: corrected (px)", decimals(5, found[2])),
        ("slow: corrected (px)", decimals(5, found[3])),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("offset of the clocks (ms)", (0.35..75.0).log_scale(), 3);
        let y_axis = ("pixel error (px)", (5e-6..1e3).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, (pace, corrected, name, place)) in CASES.into_iter().enumerate() {
            let expected = |ms: f64| (ms, expected_error(&motions[pace], 1e-3 * ms, corrected));
            chart.line([OFFSETS[0], OFFSETS[6]].map(expected), SERIES[index], 4)?;
            chart.marks(OFFSETS.into_iter().zip(found[index]), index)?;
            chart.key(index, name, place, 1.12 * place.0)?;
        }
        Ok(())
    })
}
