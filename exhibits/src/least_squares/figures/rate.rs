//! How fast Gauss-Newton arrives when measurements contradict each other more and more.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, letters_right_of, marker};
use crate::least_squares::worked::{self, GUESS, contradicting};

/// By which the contradictions of the garden are multiplied.
const FACTORS: [f64; 4] = [0.0, 1.0, 10.0, 30.0];
const STEPS: usize = 12;
/// Distances below this many metres are rounding.
const ROUNDING: f64 = 1e-14;

/// Distances of the iterates from the estimate, in metres.
fn distances(factor: f64) -> Vec<f64> {
    let tapes = contradicting(factor);
    let estimate = worked::estimate(&worked::garden());
    let mut spot = GUESS;
    let mut distances = Vec::new();
    for _ in 0..=STEPS {
        let distance = (spot - estimate).norm();
        if distance < ROUNDING {
            break;
        }
        distances.push(distance);
        spot = worked::stepped(&tapes, &spot);
    }
    distances
}

/// What the theorem says of the distances, from the third iterate on.
fn by_theorem(factor: f64, distances: &[f64]) -> Vec<(f64, f64)> {
    let estimate = worked::estimate(&worked::garden());
    let rate = worked::rate(&contradicting(factor), &estimate);
    let later = (2..distances.len().max(2)).map(|step| {
        let distance = distances[2] * rate.powi(step as i32 - 2);
        (step as f64, distance.log10())
    });
    later.filter(|place| place.1 > ROUNDING.log10()).collect()
}

pub fn rate() -> Figure {
    let series = FACTORS.map(distances);
    let rows = (0..=STEPS).map(|step| {
        let cell = |distances: &Vec<f64>| {
            distances
                .get(step)
                .map_or("below 1e-14".to_owned(), |distance| format!("{distance:.1e}"))
        };
        let mut row = vec![format!("{step}")];
        row.extend(series.iter().map(cell));
        row
    });
    Figure {
        columns: vec![
            "iteration",
            "without contradictions (m)",
            "as measured (m)",
            "10 times (m)",
            "30 times (m)",
        ],
        rows: rows.collect(),
        svg: figure::draw(820, |drawing| {
            let x_axis = ("iteration", -0.3..14.2, 8);
            let y_axis = ("log\u{2081}\u{2080} of distance (m)", -14.5..0.5, 6);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for (index, (factor, distances)) in FACTORS.into_iter().zip(&series).enumerate() {
                if factor > 0.0 {
                    let line = by_theorem(factor, distances);
                    chart.draw_series([PathElement::new(line, SERIES[index].stroke_width(4))])?;
                }
                let mut places = distances.iter().enumerate();
                let marks = places.clone().map(|(step, distance)| {
                    EmptyElement::at((step as f64, distance.log10())) + marker(index)
                });
                chart.draw_series(marks)?;
                let (last, distance) = places.next_back().unwrap_or((0, &1.0));
                let lower = if factor == 0.0 { 1.0 } else { 0.0 };
                let beside = (last as f64 + 0.4 - 1.9 * lower, distance.log10() - lower);
                let name =
                    if factor == 0.0 { "none".to_owned() } else { format!("{factor} \u{d7}") };
                chart.draw_series([Text::new(name, beside, letters_right_of(SERIES[index]))])?;
            }
            Ok(())
        }),
    }
}
