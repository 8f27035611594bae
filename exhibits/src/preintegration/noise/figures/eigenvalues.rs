//! Scatter of whitened errors: its eigenvalues beside those of numbers that are normal for certain.

use crate::figure::{self, Draw, Figure, GRID, INK, decimals, plain};
use crate::preintegration::noise::runs::{CASES, LIMITS, NORMAL, WHITENED};

/// Share of the experiments on either side of a bar.
const OUTSIDE: f64 = 0.005;

pub fn eigenvalues() -> Figure {
    let at = |share: f64| {
        let of = |sorted: &Vec<f64>| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
        NORMAL.each_ref().map(of)
    };
    let (above, below) = (at(OUTSIDE), at(1.0 - OUTSIDE));
    let found = |index: usize| decimals(3, WHITENED[index].0.iter().copied());
    let columns = vec![
        ("rank", plain(1..=9)),
        ("99 % of normal draws above", decimals(3, above)),
        ("99 % of normal draws below", decimals(3, below)),
        ("at rest", found(0)),
        ("figure-eight with the Euler rule", found(1)),
        ("figure-eight with the midpoint rule", found(2)),
    ];
    Figure::new(760, columns, |drawing| {
        let x_axis = ("eigenvalue, from small to large", 0.4..9.6, 9);
        let mut chart = figure::axes(drawing, x_axis, ("its value", 0.79..1.26, 5))?;
        for limit in LIMITS {
            chart.line([(0.4, limit), (9.6, limit)], INK, 3)?;
        }
        for rank in 0..9 {
            let x = (rank + 1) as f64;
            chart.line([(x, above[rank]), (x, below[rank])], GRID, 40)?;
        }
        for (index, (eigenvalues, _)) in WHITENED.iter().enumerate() {
            let aside = 0.17 * (index as f64 - 1.0);
            let places = eigenvalues.iter().enumerate();
            chart.marks(places.map(|(rank, value)| (rank as f64 + 1.0 + aside, *value)), index)?;
            let mark = (0.75, 1.145 - 0.042 * index as f64);
            chart.key(index, CASES[index].0, mark, 0.95)?;
        }
        Ok(())
    })
}
