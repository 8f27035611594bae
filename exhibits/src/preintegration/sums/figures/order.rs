//! Errors of the two rules over the step.

use plotters::coord::combinators::IntoLogRange;
use vislam::preintegration::Rule;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_right_of, powers,
};
use crate::preintegration::sums::rules::errors;

const STEPS: [usize; 7] = [25, 50, 100, 200, 400, 800, 1600];
const NAMES: [&str; 3] = ["rotation (µrad)", "velocity (µm/s)", "position (µm)"];

/// Errors of rotation, velocity and position for each number of steps.
type Errors = [[f64; 3]; STEPS.len()];

pub fn order() -> Figure {
    let [euler, midpoint] =
        [Rule::Euler, Rule::Midpoint].map(|rule| STEPS.map(|steps| errors(rule, steps)));
    let of = |errors: &Errors, which: usize| powers(2, errors.map(|errors| errors[which]));
    let columns = vec![
        ("step (ms)", decimals(3, STEPS.map(|steps| 1e3 / steps as f64))),
        ("Euler: rotation (rad)", of(&euler, 0)),
        ("Euler: velocity (m/s)", of(&euler, 1)),
        ("Euler: position (m)", of(&euler, 2)),
        ("midpoint: rotation (rad)", of(&midpoint, 0)),
        ("midpoint: velocity (m/s)", of(&midpoint, 1)),
        ("midpoint: position (m)", of(&midpoint, 2)),
    ];
    Figure::new(1400, columns, |drawing| {
        let (above, below) = drawing.split_vertically(670);
        panel(&above, &euler, "Euler rule, slope 1", 1, (30.0, 1e6))?;
        panel(&below, &midpoint, "midpoint rule, slope 2", 2, (1e-3, 1e5))
    })
}

fn panel(
    drawing: &Drawing,
    errors: &Errors,
    title: &str,
    slope: i32,
    (low, high): (f64, f64),
) -> Drawn {
    let x_axis = (if slope == 1 { "" } else { "step (ms)" }, (0.5..60.0).log_scale(), 4);
    let y_axis = ("error (millionths)", (low..high).log_scale(), 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    chart.write(title, (0.56, 0.4 * high), letters_right_of(INK))?;
    for (index, name) in NAMES.into_iter().enumerate() {
        let places =
            STEPS.iter().zip(errors).map(|(n, errors)| (1e3 / *n as f64, 1e6 * errors[index]));
        let through = 1e6 * errors[3][index];
        let ideal = places.clone().map(|(dt, _)| (dt, through * (dt / 5.0).powi(slope)));
        chart.line(ideal, SERIES[index], 3)?;
        chart.marks(places, index)?;
        if slope == 1 {
            chart.key(index, name, (6.5, low * [20.0, 6.0, 1.8][index]), 7.5)?;
        }
    }
    Ok(())
}
