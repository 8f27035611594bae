//! How sure the scale is, over how much the acceleration changes.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_right_of};
use crate::observability::near::{AMPLITUDES, exponent, swayed};

const NAMES: [&str; 3] = ["biases unknown", "biases known", "bound, biases known"];

pub fn excitation() -> Figure {
    let swayed = swayed();
    let curves = [&swayed.unknown, &swayed.known, &swayed.least];
    let columns = vec![
        ("amplitude of the acceleration (m/s²)", AMPLITUDES.map(|a| a.to_string()).to_vec()),
        ("sigma of the distance with unknown biases (%)", decimals(3, swayed.unknown)),
        ("with known biases (%)", decimals(3, swayed.known)),
        ("at least with known biases (%)", decimals(3, swayed.least)),
    ];
    Figure::new(920, columns, |drawing| {
        let x_axis = ("amplitude of the acceleration (m/s²)", (7e-4..16.0).log_scale(), 5);
        let y_axis = ("sigma of the distance (%)", (0.01..6e5).log_scale(), 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(7e-4, 100.0), (16.0, 100.0)], INK, 3)?;
        chart.write("nothing known", (1.2, 210.0), letters_right_of(INK))?;
        for (index, curve) in curves.into_iter().enumerate() {
            let points = || AMPLITUDES.into_iter().zip(*curve);
            chart.line(points(), SERIES[index], 4)?;
            chart.marks(points(), index)?;
            let (x, y) = (0.012, 2.8e5 / 4.0_f64.powi(index as i32));
            let slope = format!("{}, slope {:.2}", NAMES[index], exponent(points()));
            let slope = slope.replace('-', "\u{2212}");
            chart.key(index, &slope, (x, y), x * 1.25)?;
        }
        Ok(())
    })
}
