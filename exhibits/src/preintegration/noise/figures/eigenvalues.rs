//! Scatter of whitened errors: its eigenvalues beside those of numbers that are normal for certain.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::Color;

use crate::figure::{self, Figure, GRID, INK, SERIES, letters_right_of, marker};
use crate::preintegration::noise::runs::{CASES, LIMITS, NORMAL, WHITENED};

/// Share of the experiments on either side of a bar.
const OUTSIDE: f64 = 0.005;

pub fn eigenvalues() -> Figure {
    let bars: Vec<[f64; 2]> = NORMAL
        .iter()
        .map(|sorted| {
            let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
            [at(OUTSIDE), at(1.0 - OUTSIDE)]
        })
        .collect();
    let rows = bars.iter().enumerate().map(|(rank, bar)| {
        let found = WHITENED.iter().map(|(eigenvalues, _)| eigenvalues[rank]);
        let values = bar.iter().copied().chain(found).map(|value| format!("{value:.3}"));
        std::iter::once(format!("{}", rank + 1)).chain(values).collect()
    });
    Figure {
        columns: vec![
            "rank",
            "99 % of normal draws above",
            "99 % of normal draws below",
            "at rest",
            "figure-eight with the Euler rule",
            "figure-eight with the midpoint rule",
        ],
        rows: rows.collect(),
        svg: figure::draw(760, |drawing| {
            let x_axis = ("eigenvalue, from small to large", 0.4..9.6, 9);
            let mut chart = figure::axes(drawing, x_axis, ("its value", 0.79..1.26, 5))?;
            for limit in LIMITS {
                let line = [(0.4, limit), (9.6, limit)];
                chart.draw_series([PathElement::new(line, INK.stroke_width(3))])?;
            }
            for (rank, bar) in bars.iter().enumerate() {
                let x = (rank + 1) as f64;
                let line = [(x, bar[0]), (x, bar[1])];
                chart.draw_series([PathElement::new(line, GRID.stroke_width(40))])?;
            }
            for (index, (eigenvalues, _)) in WHITENED.iter().enumerate() {
                let aside = 0.17 * (index as f64 - 1.0);
                let places = eigenvalues.iter().enumerate();
                chart.draw_series(places.map(|(rank, value)| {
                    EmptyElement::at((rank as f64 + 1.0 + aside, *value)) + marker(index)
                }))?;
                let place = (0.75, 1.145 - 0.042 * index as f64);
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let beside = (place.0 + 0.2, place.1);
                let name = Text::new(CASES[index].0, beside, letters_right_of(SERIES[index]));
                chart.draw_series([name])?;
            }
            Ok(())
        }),
    }
}
