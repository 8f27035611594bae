//! The error of the motion over the share of wrong matches.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, plain};
use crate::robust_two_view::shares::{SHARES, WAYS, median};

const NAMES: [&str; WAYS.len()] = [
    "only right ones, by an oracle",
    "consensus",
    "without local optimization",
    "least squares over all",
];

pub fn shares() -> Figure {
    let of = |way: usize| SHARES.map(|share| median(way, share));
    let columns = vec![
        ("wrong (%)", plain(SHARES)),
        ("oracle (°)", decimals(2, of(0))),
        ("consensus (°)", decimals(2, of(1))),
        ("without local optimization (°)", decimals(2, of(2))),
        ("least squares over all (°)", decimals(2, of(3))),
    ];
    Figure::new(820, columns, |drawing| {
        let y_axis = ("median error (°)", (0.2..1000.0).log_scale(), 5);
        let mut chart = figure::axes(drawing, ("wrong matches (%)", -3.0..83.0, 9), y_axis)?;
        for (series, name) in NAMES.into_iter().enumerate().rev() {
            let points = SHARES.into_iter().zip(of(series)).map(|(share, off)| (share as f64, off));
            let points: Vec<(f64, f64)> = points.collect();
            chart.line(points.iter().copied(), SERIES[series], 3)?;
            chart.marks(points, series)?;
            let y = 650.0 / 1.75_f64.powi(series as i32);
            chart.key(series, name, (2.0, y), 4.0)?;
        }
        Ok(())
    })
}
