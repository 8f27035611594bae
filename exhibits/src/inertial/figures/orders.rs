//! Error of both rules over the step.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, letters_right_of, plain, powers};
use crate::inertial::rules::{RATES, exponent, position_error};

const NAMES: [&str; 2] = ["Euler", "midpoint"];

pub fn orders() -> Figure {
    let errors = [false, true].map(|midpoint| RATES.map(|rate| position_error(rate, midpoint)));
    let steps = RATES.map(|rate| 1e3 / rate);
    let columns = vec![
        ("step (ms)", plain(steps)),
        ("Euler rule (m)", powers(3, errors[0])),
        ("midpoint rule (m)", powers(3, errors[1])),
    ];
    Figure::new(820, columns, |drawing| {
        let x_axis = ("step (ms)", (0.7..150.0).log_scale(), 3);
        let y_axis = ("error of position (m)", (1e-6..100.0).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, errors) in errors.into_iter().enumerate() {
            let slope = exponent(&steps[2..], &errors[2..]);
            let last = RATES.len() - 1;
            let line = |step: f64| (step, errors[last] * (step / steps[last]).powf(slope));
            chart.line([1.0, 100.0].map(line), SERIES[index], 4)?;
            chart.marks(steps.into_iter().zip(errors), index)?;
            let name = format!("{}, slope {slope:.2}", NAMES[index]);
            let place = [(1.0, 1.0), (9.0, 2e-5)][index];
            chart.write(&name, place, letters_right_of(SERIES[index]))?;
        }
        Ok(())
    })
}
