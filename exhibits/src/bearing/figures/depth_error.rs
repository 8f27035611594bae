//! Depth error against range: the first-order formula, and where draws leave it.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::bearing::noise::{Pair, quantile};
use crate::figure::{self, Figure, SERIES, letters_right_of, marker};

/// Metres between the cameras.
const BASELINES: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Metres from the first camera.
const RANGES: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
const DRAWS: usize = 20_000;
const SEED: u64 = 32;

pub fn depth_error() -> Figure {
    let mut rows = Vec::new();
    for baseline in BASELINES {
        for range in RANGES {
            let pair = Pair { baseline, ..Pair::at_depth(range) };
            rows.push(vec![
                format!("{baseline}"),
                format!("{range}"),
                format!("{:.3}", pair.depth_sigma()),
                half_spread(&pair).map_or("unbounded".to_owned(), |spread| format!("{spread:.3}")),
            ]);
        }
    }
    Figure {
        columns: vec![
            "baseline (m)",
            "depth (m)",
            "first-order sigma (m)",
            "half the width of the middle 68.3 % of draws (m)",
        ],
        rows,
        svg: draw(),
    }
}

/// Half the width of the interval that holds the middle 68.3 % of all draws; one sigma, were they
/// normal. `None` when the interval reaches to infinity.
fn half_spread(pair: &Pair) -> Option<f64> {
    let mut depths: Vec<f64> = pair.depths(SEED).take(DRAWS).collect();
    let spread = (quantile(&mut depths, 0.8415) - quantile(&mut depths, 0.1585)) / 2.0;
    spread.is_finite().then_some(spread)
}

fn draw() -> String {
    figure::draw(860, |drawing| {
        let x_axis = ("depth (m)", (0.9..110.0).log_scale(), 3);
        let y_axis = ("depth error (m)", (0.002..200.0).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, baseline) in BASELINES.into_iter().enumerate() {
            let pair = |range| Pair { baseline, ..Pair::at_depth(range) };
            let line = RANGES.map(|range| (range, pair(range).depth_sigma()));
            let end = line[RANGES.len() - 1];
            chart.draw_series(LineSeries::new(line, SERIES[index].stroke_width(4)))?;
            let draws =
                RANGES.iter().filter_map(|range| Some((*range, half_spread(&pair(*range))?)));
            chart.draw_series(draws.map(|place| EmptyElement::at(place) + marker(index)))?;
            let name = format!("{baseline} m");
            let beside = (1.12 * end.0, end.1);
            chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
        }
        Ok(())
    })
}
