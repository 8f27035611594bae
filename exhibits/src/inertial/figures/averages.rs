//! Means of a resting gyroscope's readings over longer and longer times.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, geometric, plain};
use crate::inertial::averages::{cases, errors_of_means, expected_error};

/// Seconds.
const TIMES: [f64; 9] = [0.2, 0.5, 2.0, 5.0, 15.0, 40.0, 100.0, 250.0, 600.0];

pub fn averages() -> Figure {
    let found = cases().map(|case| errors_of_means(case, &TIMES));
    let seen = |index: usize| decimals(4, found[index].iter().map(|error| error.to_degrees()));
    let expected = |index: usize, time| expected_error(cases()[index], time).to_degrees();
    let formula = |index: usize| decimals(4, TIMES.map(|time| expected(index, time)));
    let columns = vec![
        ("time (s)", plain(TIMES)),
        ("no bias (°/s)", seen(0)),
        ("formula (°/s)", formula(0)),
        ("a bias stays (°/s)", seen(1)),
        ("formula (°/s)", formula(1)),
        ("a bias walks (°/s)", seen(2)),
        ("formula (°/s)", formula(2)),
    ];
    Figure::new(820, columns, |drawing| {
        let x_axis = ("averaged over (s)", (0.15..800.0).log_scale(), 4);
        let y_axis = ("error of the mean (°/s)", (0.005..1.0).log_scale(), 3);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, (name, ..)) in cases().into_iter().enumerate() {
            let curve = geometric(0.2, 3000.0, 60).map(|t| (t, expected(index, t)));
            chart.line(curve, SERIES[index], 5)?;
            let places = TIMES.iter().zip(&found[index]);
            chart.marks(places.map(|(t, error)| (*t, error.to_degrees())), index)?;
            chart.key(index, name, (0.22, [0.022, 0.0135, 0.0083][index]), 0.275)?;
        }
        Ok(())
    })
}
