//! How sure the scale is, over how much the acceleration changes.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, INK, SERIES, letters_right_of, marker};
use crate::observability::near::{AMPLITUDES, exponent, swayed};

const NAMES: [&str; 3] = ["biases unknown", "biases known", "bound, biases known"];

pub fn excitation() -> Figure {
    let swayed = swayed();
    let curves = [&swayed.unknown, &swayed.known, &swayed.least];
    let rows = AMPLITUDES.iter().enumerate().map(|(row, amplitude)| {
        let mut cells = vec![amplitude.to_string()];
        cells.extend(curves.iter().map(|curve| format!("{:.3}", curve[row])));
        cells
    });
    Figure {
        columns: vec![
            "amplitude of the acceleration (m/s²)",
            "sigma of the distance with unknown biases (%)",
            "with known biases (%)",
            "at least with known biases (%)",
        ],
        rows: rows.collect(),
        svg: figure::draw(920, |drawing| {
            let x_axis = ("amplitude of the acceleration (m/s²)", (7e-4..16.0).log_scale(), 5);
            let y_axis = ("sigma of the distance (%)", (0.01..6e5).log_scale(), 7);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            let all = [(7e-4, 100.0), (16.0, 100.0)];
            chart.draw_series([PathElement::new(all, INK.stroke_width(3))])?;
            chart.draw_series([Text::new("nothing known", (1.2, 210.0), letters_right_of(INK))])?;
            for (index, curve) in curves.iter().enumerate() {
                let points: Vec<_> = AMPLITUDES.into_iter().zip(curve.iter().copied()).collect();
                chart
                    .draw_series(LineSeries::new(points.clone(), SERIES[index].stroke_width(4)))?;
                chart.draw_series(points.iter().map(|at| EmptyElement::at(*at) + marker(index)))?;
                let place = (0.012, 2.8e5 / 4.0_f64.powi(index as i32));
                chart.draw_series([EmptyElement::at(place) + marker(index)])?;
                let slope = format!("{}, slope {:.2}", NAMES[index], exponent(&points));
                let slope = slope.replace('-', "\u{2212}");
                let beside = (place.0 * 1.25, place.1);
                chart.draw_series([Text::new(slope, beside, letters_right_of(SERIES[index]))])?;
            }
            Ok(())
        }),
    }
}
