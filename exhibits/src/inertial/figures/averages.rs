//! Means of a resting gyroscope's readings over longer and longer times.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, letters_right_of, marker};
use crate::inertial::averages::{Case, errors_of_means, expected_error};

/// Seconds.
const TIMES: [f64; 9] = [0.2, 0.5, 2.0, 5.0, 15.0, 40.0, 100.0, 250.0, 600.0];

const CASES: [(Case, &str); 3] =
    [(Case::NoBias, "no bias"), (Case::Stays, "a bias stays"), (Case::Walks, "a bias walks")];

pub fn averages() -> Figure {
    let found = CASES.map(|(case, _)| errors_of_means(case, &TIMES));
    let rows = TIMES.iter().enumerate().map(|(index, time)| {
        let mut row = vec![format!("{time}")];
        for ((case, _), found) in CASES.iter().zip(&found) {
            let both = [found[index], expected_error(*case, *time)];
            row.extend(both.map(|error| format!("{:.4}", error.to_degrees())));
        }
        row
    });
    Figure {
        columns: vec![
            "time (s)",
            "no bias (°/s)",
            "formula (°/s)",
            "a bias stays (°/s)",
            "formula (°/s)",
            "a bias walks (°/s)",
            "formula (°/s)",
        ],
        rows: rows.collect(),
        svg: figure::draw(820, |drawing| {
            let x_axis = ("averaged over (s)", (0.15..800.0).log_scale(), 4);
            let y_axis = ("error of the mean (°/s)", (0.005..1.0).log_scale(), 3);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for (index, (case, name)) in CASES.iter().enumerate() {
                let times = (0..=60).map(|k| 0.2 * 3000_f64.powf(f64::from(k) / 60.0));
                let curve = times.map(|t| (t, expected_error(*case, t).to_degrees()));
                let colour = SERIES[index];
                chart.draw_series(LineSeries::new(curve, colour.stroke_width(5)))?;
                let places = TIMES.iter().zip(&found[index]);
                let marks = places
                    .map(|(t, error)| EmptyElement::at((*t, error.to_degrees())) + marker(index));
                chart.draw_series(marks)?;
                let place = (0.22, [0.022, 0.0135, 0.0083][index]);
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let beside = (1.25 * place.0, place.1);
                chart.draw_series([Text::new(*name, beside, letters_right_of(colour))])?;
            }
            Ok(())
        }),
    }
}
