//! Time of one evaluation over the number of readings, from the accepted record.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, plain};
use crate::preintegration::sums::cost::{READINGS, recorded};

const NAMES: [&str; 3] = ["readings: the state alone", "readings: with derivatives", "one factor"];

pub fn cost() -> Figure {
    let recorded = recorded();
    let times = |which: usize| decimals(3, recorded.map(|times| times[which]));
    let columns = vec![
        ("readings", plain(READINGS)),
        ("the state alone from readings (us)", times(0)),
        ("with derivatives from readings (us)", times(1)),
        ("from the factor (us)", times(2)),
    ];
    Figure::new(820, columns, |drawing| {
        let lowest = recorded.iter().flatten().fold(f64::INFINITY, |a, b| a.min(*b));
        let highest = recorded.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
        let x_axis = ("readings in the interval", (15.0..1400.0).log_scale(), 4);
        let y_axis = ("µs", (0.4 * lowest..20.0 * highest).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for index in [1, 0, 2] {
            let places = READINGS.iter().zip(&recorded).map(|(n, times)| (*n as f64, times[index]));
            chart.line(places.clone(), SERIES[index], 4)?;
            chart.marks(places, index)?;
            let height = highest * [4.0, 10.0, 1.6][index];
            chart.key(index, NAMES[index], (20.0, height), 23.0)?;
        }
        Ok(())
    })
}
