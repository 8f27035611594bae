//! Error of both rules over the step.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, letters_right_of, marker};
use crate::inertial::rules::{RATES, exponent, position_error};

const NAMES: [&str; 2] = ["Euler", "midpoint"];

pub fn orders() -> Figure {
    let errors = [false, true].map(|midpoint| RATES.map(|rate| position_error(rate, midpoint)));
    let steps = RATES.map(|rate| 1e3 / rate);
    let rows = steps.iter().enumerate().map(|(index, step)| {
        let errors = errors.each_ref().map(|errors| format!("{:.3e}", errors[index]));
        [vec![format!("{step}")], errors.to_vec()].concat()
    });
    Figure {
        columns: vec!["step (ms)", "Euler rule (m)", "midpoint rule (m)"],
        rows: rows.collect(),
        svg: figure::draw(820, |drawing| {
            let x_axis = ("step (ms)", (0.7..150.0).log_scale(), 3);
            let y_axis = ("error of position (m)", (1e-6..100.0).log_scale(), 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for (index, errors) in errors.iter().enumerate() {
                let slope = exponent(&steps[2..], &errors[2..]);
                let last = RATES.len() - 1;
                let line = |step: f64| errors[last] * (step / steps[last]).powf(slope);
                let ends = [1.0, 100.0].map(|step| (step, line(step)));
                let colour = SERIES[index];
                chart.draw_series(LineSeries::new(ends, colour.stroke_width(4)))?;
                let marks = steps.iter().zip(errors);
                chart
                    .draw_series(marks.map(|(s, e)| EmptyElement::at((*s, *e)) + marker(index)))?;
                let name = format!("{}, slope {slope:.2}", NAMES[index]);
                let place = [(1.0, 1.0), (9.0, 2e-5)][index];
                chart.draw_series([Text::new(name, place, letters_right_of(colour))])?;
            }
            Ok(())
        }),
    }
}
