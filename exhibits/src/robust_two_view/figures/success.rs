//! The probability of the right motion over the number of draws.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{
    self, Draw, Figure, INK, SERIES, decimals, geometric, letters_right_of, plain,
};
use crate::robust_two_view::success::{AFTER, measured, predicted};

const NAMES: [&str; 3] = ["without noise", "a pixel of noise", "noise, optimized"];

pub fn success() -> Figure {
    let measured = measured();
    // Where nothing was measured the cell stays empty.
    let percent = |parts: &[f64]| {
        let mut cells = decimals(0, parts.iter().map(|part| 100.0 * part));
        cells.resize(AFTER.len(), String::new());
        cells
    };
    let columns = vec![
        ("draws", plain(AFTER)),
        ("predicted (%)", decimals(0, AFTER.map(|draws| 100.0 * predicted(draws as f64)))),
        ("without noise (%)", percent(&measured[0])),
        ("a pixel of noise (%)", percent(&measured[1])),
        ("noise, with local optimization (%)", percent(&measured[2])),
    ];
    Figure::new(820, columns, |drawing| {
        let x_axis = ("draws", (8.0..3200.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, ("right motion (%)", 0.0..112.0, 6))?;
        let draws = geometric(8.0, 400.0, 80);
        chart.line(draws.map(|n| (n, 100.0 * predicted(n))), INK, 5)?;
        for (series, parts) in measured.iter().enumerate() {
            let points: Vec<(f64, f64)> =
                AFTER.iter().zip(parts).map(|(n, part)| (*n as f64, 100.0 * part)).collect();
            chart.line(points.iter().copied(), SERIES[series], 3)?;
            chart.marks(points, series)?;
            chart.key(series, NAMES[series], (10.0, 92.0 - 9.0 * series as f64), 11.5)?;
        }
        chart.line([(9.3, 101.0), (10.8, 101.0)], INK, 5)?;
        chart.write("predicted", (11.5, 101.0), letters_right_of(INK))
    })
}
