//! The cost over the steps, from odometry and from the chord.

use crate::figure::{self, Draw, Figure, powers};
use crate::loop_closure::sphere::searches;

const NAMES: [&str; 2] = ["from the chord", "from odometry"];

pub fn steps() -> Figure {
    let [odometry, chordal] = searches();
    let costs = [&chordal.costs, &odometry.costs];
    let longest = costs.map(Vec::len).into_iter().max().unwrap_or(0);
    // A search that has ended has no further costs.
    let cells = |costs: &[f64]| {
        let mut cells = powers(4, costs.iter().copied());
        cells.resize(longest, String::new());
        cells
    };
    let columns = vec![
        ("steps", figure::plain(0..longest)),
        ("cost from the chord", cells(costs[0])),
        ("cost from odometry", cells(costs[1])),
    ];
    let lowest = costs[0][costs[0].len() - 1].log10();
    let highest = costs[1].iter().fold(0.0_f64, |most, cost| most.max(cost.log10()));
    Figure::new(760, columns, |drawing| {
        let x_axis = ("steps", -0.5..longest as f64, 9);
        let y_axis = ("log\u{2081}\u{2080} of the cost", lowest - 0.3..highest + 0.6, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (series, costs) in costs.into_iter().enumerate() {
            let points: Vec<(f64, f64)> =
                costs.iter().enumerate().map(|(at, cost)| (at as f64, cost.log10())).collect();
            chart.line(points.iter().copied(), figure::SERIES[series], 4)?;
            chart.marks(points, series)?;
            let x = 0.45 * longest as f64;
            let y = highest + 0.25 - 0.45 * series as f64;
            chart.key(series, NAMES[series], (x, y), x + 0.02 * longest as f64)?;
        }
        Ok(())
    })
}
