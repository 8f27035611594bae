//! Tracks that survive, over the share of wrong matches.

use crate::figure::{self, Draw, Figure, decimals};
use crate::structure_from_motion::survival::{SHARES, WAYS, all};

pub fn survival() -> Figure {
    let percent = |values: &[f64]| decimals(0, values.iter().map(|value| 100.0 * value));
    let all = all();
    let mut columns = vec![("wrong matches (%)", percent(&SHARES))];
    let titles = ["all joined (%)", "contradictions refused (%)", "verified, then joined (%)"];
    columns.extend(titles.into_iter().zip(all).map(|(title, values)| (title, percent(values))));
    Figure::new(820, columns, |drawing| {
        let axes =
            [("wrong matches (%)", -2.0..42.0, 9), ("tracks that survive (%)", -4.0..108.0, 6)];
        let [x_axis, y_axis] = axes;
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (way, values) in all.iter().enumerate() {
            let points: Vec<(f64, f64)> =
                SHARES.iter().zip(values).map(|(x, y)| (100.0 * x, 100.0 * y)).collect();
            chart.line(points.iter().copied(), figure::SERIES[way], 4)?;
            chart.marks(points, way)?;
            let y = 78.0 - 9.0 * way as f64;
            chart.key(way, WAYS[way], (23.0, y), 24.0)?;
        }
        Ok(())
    })
}
