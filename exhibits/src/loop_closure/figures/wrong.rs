//! The error over the number of wrong loops.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, decimals, letters_around};
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
    for (title, outcomes) in titles.into_iter().zip(all) {
        columns.push((title, decimals(3, outcomes.iter().map(|outcome| outcome.error))));
    }
    columns.push(("of them believed: switches", believed(3)));
    columns.push(("of them believed: graduated", believed(4)));
    // Each count has a place of its own, as there is no logarithm of none.
    let place = |at: usize, way: usize| at as f64 + 0.06 * (way as f64 - 2.0);
    Figure::new(980, columns, |drawing| {
        let x_axis = ("wrong loops", -0.4..7.4, 0);
        let y_axis = ("error (m)", (0.03..300.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (way, outcomes) in all.iter().enumerate() {
            let points: Vec<(f64, f64)> =
                (0..).zip(outcomes).map(|(at, it)| (place(at, way), it.error)).collect();
            chart.line(points.iter().copied(), figure::SERIES[way], 4)?;
            chart.marks(points, way)?;
            let (x, y) = ([0.0, 2.8, 5.0][way % 3], [180.0, 80.0][way / 3]);
            chart.key(way, WAYS[way], (x, y), x + 0.15)?;
        }
        for (at, count) in COUNTS.iter().enumerate() {
            chart.write(&count.to_string(), (at as f64, 0.04), letters_around(INK))?;
        }
        Ok(())
    })
}

/// How many wrong loops a way believes, by their number.
fn believed(way: usize) -> Vec<String> {
    figure::plain(all()[way].iter().map(|outcome| outcome.believed[1]))
}
