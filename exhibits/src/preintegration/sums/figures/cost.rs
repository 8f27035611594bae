//! Time of one evaluation over the number of readings, from the accepted record.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::figure::{self, Figure, SERIES, letters_right_of, marker};
use crate::preintegration::sums::cost::{READINGS, recorded};

const NAMES: [&str; 3] = ["readings: the state alone", "readings: with derivatives", "one factor"];

pub fn cost() -> Figure {
    let recorded = recorded();
    let rows = READINGS.iter().zip(&recorded).map(|(n, times)| {
        let mut row = vec![format!("{n}")];
        row.extend(times.map(|time| format!("{time:.3}")));
        row
    });
    Figure {
        columns: vec![
            "readings",
            "the state alone from readings (us)",
            "with derivatives from readings (us)",
            "from the factor (us)",
        ],
        rows: rows.collect(),
        svg: figure::draw(820, |drawing| {
            let lowest = recorded.iter().flatten().fold(f64::INFINITY, |a, b| a.min(*b));
            let highest = recorded.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
            let x_axis = ("readings in the interval", (15.0..1400.0).log_scale(), 4);
            let y_axis = ("µs", (0.4 * lowest..20.0 * highest).log_scale(), 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            for index in [1, 0, 2] {
                let places =
                    READINGS.iter().zip(&recorded).map(|(n, times)| (*n as f64, times[index]));
                let line = LineSeries::new(places.clone(), SERIES[index].stroke_width(4));
                chart.draw_series(line)?;
                chart.draw_series(places.map(|place| EmptyElement::at(place) + marker(index)))?;
                let height = highest * [4.0, 10.0, 1.6][index];
                chart.draw_series([EmptyElement::at((20.0, height)) + marker(index)])?;
                let name = Text::new(NAMES[index], (23.0, height), letters_right_of(SERIES[index]));
                chart.draw_series([name])?;
            }
            Ok(())
        }),
    }
}
