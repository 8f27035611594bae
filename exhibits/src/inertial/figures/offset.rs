//! Pixel error over the offset between two clocks, before and after a first-order correction.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, letters_right_of, marker};
use crate::inertial::clock::{PACES, expected_error, offset_error, paced};

/// Milliseconds.
const OFFSETS: [f64; 7] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

/// Which pace, and whether corrected.
const CASES: [(usize, bool, &str); 4] = [
    (1, false, "fast"),
    (0, false, "slow"),
    (1, true, "fast, corrected"),
    (0, true, "slow, corrected"),
];

pub fn offset() -> Figure {
    let motions = PACES.map(paced);
    let found = CASES.map(|(pace, corrected, _)| {
        OFFSETS.map(|ms| offset_error(&motions[pace], 1e-3 * ms, corrected))
    });
    let rows = OFFSETS.iter().enumerate().map(|(index, ms)| {
        let mut row = vec![format!("{ms}")];
        row.extend(found.iter().map(|errors| format!("{:.5}", errors[index])));
        row
    });
    Figure {
        columns: vec![
            "offset (ms)",
            "fast (px)",
            "slow (px)",
            "fast: corrected (px)",
            "slow: corrected (px)",
        ],
        rows: rows.collect(),
        svg: figure::draw(900, |drawing| {
            let x_axis = ("offset of the clocks (ms)", (0.35..75.0).log_scale(), 3);
            let y_axis = ("pixel error (px)", (5e-6..1e3).log_scale(), 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for (index, (pace, corrected, name)) in CASES.iter().enumerate() {
                let expected = |ms: f64| expected_error(&motions[*pace], 1e-3 * ms, *corrected);
                let line = [OFFSETS[0], OFFSETS[6]].map(|ms| (ms, expected(ms)));
                let colour = SERIES[index];
                chart.draw_series(LineSeries::new(line, colour.stroke_width(4)))?;
                let places = OFFSETS.iter().zip(&found[index]);
                chart.draw_series(
                    places.map(|(ms, px)| EmptyElement::at((*ms, *px)) + marker(index)),
                )?;
                let place = (0.42, 3.5e2 / 4_f64.powi(index as i32));
                let place = if index < 2 { place } else { (5.0, [1.5e-4, 3e-5][index - 2]) };
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let beside = (1.12 * place.0, place.1);
                chart.draw_series([Text::new(*name, beside, letters_right_of(colour))])?;
            }
            Ok(())
        }),
    }
}
