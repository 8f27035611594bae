//! What is reported of an end of a link that was dropped.

use crate::figure::{self, Draw, Figure, INK, decimals};
use crate::marginalization::windows::{WAYS, dropped_links};
use plotters::coord::combinators::IntoLogRange;

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
        ("as the SEIF does", cells(2)),
    ];
    let most = all.iter().map(|d| d.sigma).fold(0.0, f64::max);
    let least = all.iter().map(|d| d.sigma).fold(f64::INFINITY, f64::min);
    let ratios = || all.iter().flat_map(|d| d.reported).flatten();
    let low = ratios().fold(f64::INFINITY, f64::min);
    let high = ratios().fold(0.0, f64::max);
    Figure::new(900, columns, |drawing| {
        let x_axis = ("true sigma of the position (mm)", (least / 1.1..most * 1.1).log_scale(), 5);
        let y_axis = ("reported over true sigma", (low / 1.2..high * 3.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(least / 1.1, 1.0), (most * 1.1, 1.0)], INK, 3)?;
        for (way, name) in WAYS.iter().enumerate() {
            let points = all.iter().filter_map(|d| Some((d.sigma, d.reported[way]?)));
            chart.marks(points.collect::<Vec<_>>(), way)?;
            let (x, y) = (least * 1.05, high * 2.5 / 1.3_f64.powi(way as i32));
            chart.key(way, name, (x, y), x * 1.05)?;
        }
        Ok(())
    })
}
