//! Where searches ended, and what the certificate says.

use std::collections::BTreeMap;

use crate::figure::{self, Column, Draw, Figure};
use crate::loop_closure::certificate::{End, searches};

/// Ends that are told apart by four decimals, and how many searches came to each.
fn ends_that_differ(ends: &[End]) -> Vec<Column> {
    let eigenvalue =
        |end: &End| end.eigenvalue.map_or("certified".to_owned(), |value| format!("{value:.4}"));
    let mut searches = BTreeMap::new();
    for end in ends {
        *searches.entry((format!("{:.4}", end.cost), eigenvalue(end))).or_insert(0) += 1;
    }
    vec![
        ("cost over the lowest one", searches.keys().map(|(cost, _)| cost.clone()).collect()),
        ("smallest eigenvalue over the weight", searches.keys().map(|(_, e)| e.clone()).collect()),
        ("searches", searches.values().map(i32::to_string).collect()),
    ]
}

pub fn minima() -> Figure {
    let ends = searches().concat();
    let columns = ends_that_differ(&ends);
    let (most, deepest) = ends.iter().fold((1.0_f64, 0.0_f64), |(most, deepest), end| {
        (most.max(end.cost), deepest.min(end.eigenvalue.unwrap_or(0.0)))
    });
    Figure::new(820, columns, |drawing| {
        let x_axis = ("cost over the lowest one of the graph", 0.8..1.05 * most, 6);
        let y_axis = ("smallest eigenvalue over the weight", 1.1 * deepest..-0.3 * deepest, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        let kinds = ["certified", "refused, and not the lowest", "refused, the lowest found"];
        let kind_of = |end: &End| match (end.eigenvalue, end.is_lowest()) {
            (None, _) => 0,
            (Some(_), false) => 1,
            (Some(_), true) => 2,
        };
        // The certified stand last, so that none is hidden.
        for (series, name) in kinds.into_iter().enumerate().rev() {
            let points = ends.iter().filter(|end| kind_of(end) == series);
            let points = points.map(|end| (end.cost, end.eigenvalue.unwrap_or(0.0)));
            chart.marks(points.collect::<Vec<_>>(), series)?;
            let x = 1.0 + 0.3 * (most - 1.0);
            let y = -deepest * (0.24 - 0.075 * series as f64);
            chart.key(series, name, (x, y), x + 0.02 * most)?;
        }
        Ok(())
    })
}
