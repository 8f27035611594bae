//! Errors of the two rules over the step.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::preintegration::Rule;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::preintegration::sums::rules::errors;

const STEPS: [usize; 7] = [25, 50, 100, 200, 400, 800, 1600];
const NAMES: [&str; 3] = ["rotation (µrad)", "velocity (µm/s)", "position (µm)"];

pub fn order() -> Figure {
    let both = [Rule::Euler, Rule::Midpoint].map(|rule| STEPS.map(|steps| errors(rule, steps)));
    let rows = STEPS.iter().enumerate().map(|(index, steps)| {
        let mut row = vec![format!("{:.3}", 1e3 / *steps as f64)];
        row.extend(
            both.iter().flat_map(|errors| errors[index].map(|error| format!("{error:.2e}"))),
        );
        row
    });
    Figure {
        columns: vec![
            "step (ms)",
            "Euler: rotation (rad)",
            "Euler: velocity (m/s)",
            "Euler: position (m)",
            "midpoint: rotation (rad)",
            "midpoint: velocity (m/s)",
            "midpoint: position (m)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1400, |drawing| {
            let (above, below) = drawing.split_vertically(670);
            panel(&above, &both[0], "Euler rule, slope 1", 1, (30.0, 1e6))?;
            panel(&below, &both[1], "midpoint rule, slope 2", 2, (1e-3, 1e5))
        }),
    }
}

fn panel(
    drawing: &Drawing,
    errors: &[[f64; 3]; STEPS.len()],
    title: &'static str,
    slope: i32,
    (low, high): (f64, f64),
) -> Drawn {
    let x_title = if slope == 1 { "" } else { "step (ms)" };
    let x_axis = (x_title, (0.5..60.0).log_scale(), 4);
    let mut chart =
        figure::axes(drawing, x_axis, ("error (millionths)", (low..high).log_scale(), 5))?;
    chart.draw_series([Text::new(title, (0.56, 0.4 * high), letters_right_of(INK))])?;
    for index in 0..3 {
        let places =
            STEPS.iter().zip(errors).map(|(n, errors)| (1e3 / *n as f64, 1e6 * errors[index]));
        let through = 1e6 * errors[3][index];
        let ideal = places.clone().map(|(dt, _)| (dt, through * (dt / 5.0).powi(slope)));
        chart.draw_series(LineSeries::new(ideal, SERIES[index].stroke_width(3)))?;
        chart.draw_series(places.map(|place| EmptyElement::at(place) + marker(index)))?;
        if slope == 1 {
            let height = low * [40.0, 12.0, 3.6][index];
            chart.draw_series([EmptyElement::at((6.5, height * 0.5)) + marker(index)])?;
            let name =
                Text::new(NAMES[index], (7.5, height * 0.5), letters_right_of(SERIES[index]));
            chart.draw_series([name])?;
        }
    }
    Ok(())
}
