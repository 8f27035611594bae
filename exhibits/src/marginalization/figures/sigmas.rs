//! What is reported of an end of a link that was dropped.

use crate::figure::{self, Draw, Figure, INK, decimals, letters_around};
use crate::marginalization::windows::{WAYS, dropped_links};

pub fn sigmas() -> Figure {
    let all = dropped_links();
    let cells = |way: usize| {
        let cell = |ratio: Option<f64>| ratio.map_or("none".to_owned(), |r| format!("{r:.3}"));
        all.iter().map(move |d| cell(d.reported[way])).collect()
    };
    let columns = vec![
        ("block", figure::plain(all.iter().map(|d| d.link.0))),
        ("link with", figure::plain(all.iter().map(|d| d.link.1))),
        ("true sigma of its position (mm)", decimals(2, all.iter().map(|d| d.sigma))),
        ("reported over true, zeroed", cells(0)),
        ("marginals kept", cells(1)),
        ("with the rule of the sparse extended information filter (SEIF)", cells(2)),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("true sigma of the position (mm)", 0.0..340.0, 6);
        let y_axis = ("reported over true sigma", 0.3..2.3, 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(0.0, 1.0), (340.0, 1.0)], INK, 3)?;
        for (way, name) in WAYS.iter().enumerate() {
            let points = all.iter().filter_map(|d| Some((d.sigma, d.reported[way]?)));
            chart.marks(points.collect::<Vec<_>>(), way)?;
            let (x, y) = (12.0, 2.2 - 0.13 * way as f64);
            chart.key(way, name, (x, y), x + 8.0)?;
        }
        for (name, x) in [("keyframes", 65.0), ("landmarks", 235.0)] {
            chart.write(name, (x, 0.36), letters_around(INK))?;
        }
        Ok(())
    })
}
