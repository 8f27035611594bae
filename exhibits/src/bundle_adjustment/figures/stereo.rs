//! The smallest eigenvalues of the reduced system, with one camera and with two.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::bundle_adjustment::stereo::{BASELINE, eigenvalues, ring};
use crate::figure::{self, Drawing, Drawn, Figure, GRID, INK, SERIES, letters_right_of, marker};

const SHOWN: usize = 10;
/// What is below this is rounding, and all of it is shown on one level.
const ROUNDING: f64 = 1e-13;
const LEVEL: f64 = -15.0;
const CASES: [(&str, Option<f64>, bool); 4] = [
    ("one camera, free", None, false),
    ("stereo, free", Some(BASELINE), false),
    ("one camera, pinned", None, true),
    ("stereo, pinned", Some(BASELINE), true),
];
/// Metres.
const BASELINES: [f64; 7] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0];

pub fn stereo() -> Figure {
    let cases = CASES.map(|(_, baseline, pinned)| eigenvalues(&ring(baseline, pinned)));
    let by_baseline = BASELINES.map(|baseline| {
        let values = eigenvalues(&ring(Some(baseline), true));
        [values[0], values[1]]
    });
    let shown = |value: f64| {
        if value < ROUNDING { "below 1e-13".to_owned() } else { format!("{value:.2e}") }
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (case, values) in CASES.iter().zip(&cases) {
        for (index, value) in values.iter().take(SHOWN).enumerate() {
            let baseline = case.1.map_or("none".to_owned(), |baseline| baseline.to_string());
            let name = case.0.replace(',', ":");
            rows.push(vec![name, baseline, (index + 1).to_string(), shown(*value)]);
        }
    }
    for (baseline, values) in BASELINES.iter().zip(&by_baseline) {
        for (index, value) in values.iter().enumerate() {
            let name = CASES[3].0.replace(',', ":");
            rows.push(vec![name, baseline.to_string(), (index + 1).to_string(), shown(*value)]);
        }
    }
    Figure {
        columns: vec!["case", "baseline (m)", "which eigenvalue", "its value"],
        rows,
        svg: figure::draw(1500, |drawing| {
            let (above, below) = drawing.split_vertically(880);
            spectra(&above, &cases)?;
            over_baseline(&below, &by_baseline)
        }),
    }
}

fn spectra(drawing: &Drawing, cases: &[Vec<f64>; 4]) -> Drawn {
    let x_axis = ("which eigenvalue, from the smallest", 0.4..10.6, 10);
    let y_axis = ("log\u{2081}\u{2080} of eigenvalue", -15.8..2.8, 6);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    chart.draw_series([PathElement::new([(0.4, -14.0), (10.6, -14.0)], GRID.stroke_width(4))])?;
    for (index, values) in cases.iter().enumerate() {
        let places = values.iter().take(SHOWN).enumerate().map(|(order, value)| {
            // Marks of one place stand side by side.
            let aside = 0.16 * (index as f64 - 1.5);
            let height = if *value < ROUNDING { LEVEL } else { value.log10() };
            (order as f64 + 1.0 + aside, height)
        });
        chart.draw_series(places.map(|place| EmptyElement::at(place) + marker(index)))?;
        let place = (5.5 * (index % 2) as f64 + 0.8, if index < 2 { 2.0 } else { 0.6 });
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let beside = (place.0 + 0.25, place.1);
        let name = Text::new(CASES[index].0, beside, letters_right_of(SERIES[index]));
        chart.draw_series([name])?;
    }
    chart.draw_series([Text::new("rounding", (8.2, -14.6), letters_right_of(INK))])?;
    Ok(())
}

fn over_baseline(drawing: &Drawing, values: &[[f64; 2]; BASELINES.len()]) -> Drawn {
    let x_axis = ("baseline (m)", (7e-4..1.4).log_scale(), 4);
    let y_axis = ("log\u{2081}\u{2080} of eigenvalue", -8.0..0.0, 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    for (order, series) in [(0, 3), (1, 4)] {
        let places: Vec<_> = BASELINES
            .iter()
            .zip(values)
            .map(|(baseline, values)| (*baseline, values[order].log10()))
            .collect();
        let line = LineSeries::new(places.clone(), SERIES[series].stroke_width(4));
        chart.draw_series(line)?;
        chart.draw_series(places.iter().map(|place| EmptyElement::at(*place) + marker(series)))?;
        let name = if order == 0 { "smallest" } else { "next" };
        let beside = (places[1].0 * 0.9, places[1].1 + if order == 0 { 1.0 } else { 0.6 });
        chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[series]))])?;
    }
    Ok(())
}
