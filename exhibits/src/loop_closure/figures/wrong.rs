//! The error over the number of wrong loops.

use crate::figure::{self, Draw, Figure, decimals};
use crate::loop_closure::wrong::{COUNTS, WAYS, all};

pub fn wrong() -> Figure {
    let all = all();
    let mut columns = vec![("wrong loops", figure::plain(COUNTS))];
    let titles = [
        "least squares (m)",
        "Huber (m)",
        "Cauchy (m)",
        "switches (m)",
        "graduated non-convexity (m)",
    ];
    for (title, errors) in titles.into_iter().zip(all) {
        columns.push((title, decimals(3, *errors)));
    }
    Figure::new(980, columns, |drawing| {
        let (low, high) = (-1.2, 2.3);
        let x_axis = ("log\u{2082} of one plus the number of wrong loops", -0.4..7.2, 8);
        let y_axis = ("log\u{2081}\u{2080} of the error in metres", low..high, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (way, errors) in all.iter().enumerate() {
            // Ways that agree stand beside each other.
            let aside = 0.05 * (way as f64 - 2.0);
            let points: Vec<(f64, f64)> = COUNTS
                .iter()
                .zip(errors)
                .map(|(count, error)| (((1 + count) as f64).log2() + aside, error.log10()))
                .collect();
            chart.line(points.iter().copied(), figure::SERIES[way], 4)?;
            chart.marks(points, way)?;
            let (x, y) = ([0.0, 2.6, 4.6][way % 3], [2.1, 1.8][way / 3]);
            chart.key(way, WAYS[way], (x, y), x + 0.15)?;
        }
        Ok(())
    })
}
