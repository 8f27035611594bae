//! How normalized errors are distributed, and how they should be.

use vislam::filtering::{chi_square_below, chi_square_quantile};

use crate::bundle_adjustment::consistency::{
    DEGREES, SHOWN_RUNS as RUNS, errors, live_errors, of_run,
};
use crate::comparison::altered;
use crate::figure::{
    self, Draw, Figure, GRID, INK, SERIES, decimals, letters_around, letters_right_of,
};

/// Pixels of noise where one is stated.
const UNDERSTATED: f64 = 1.3;
const SHARES: [f64; 19] = [
    0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85,
    0.9, 0.95,
];

pub fn consistency() -> Figure {
    let errors = [live_errors().to_vec(), errors(RUNS, UNDERSTATED)];
    let sorted = errors.map(|errors| altered(errors, |errors| errors.sort_by(f64::total_cmp)));
    let of_share = |run: usize| SHARES.map(|share| sorted[run][(share * RUNS as f64) as usize]);
    let expected = SHARES.map(|share| chi_square_quantile(share, DEGREES).expect("a probability"));
    let columns = vec![
        ("share of runs below", decimals(2, SHARES)),
        ("chi-square of 41 degrees of freedom", decimals(1, expected)),
        ("normalized error with the noise as stated", decimals(1, of_share(0))),
        ("with 1.3 px where 1 px is stated", decimals(1, of_share(1))),
    ];
    Figure::new(780, columns, |drawing| {
        let x_axis = ("normalized error of a run", 10.0..112.0, 6);
        let mut chart = figure::axes(drawing, x_axis, ("share of runs below", 0.0..1.0, 5))?;
        for end in of_run() {
            chart.line([(end, 0.0), (end, 1.0)], GRID, 6)?;
        }
        let curve = (0..=200).map(|step| 10.0 + 0.51 * f64::from(step));
        chart.line(curve.map(|x| (x, chi_square_below(x, DEGREES))), INK, 5)?;
        for (index, errors) in sorted.iter().enumerate() {
            let places = errors.iter().enumerate().skip(1).step_by(4);
            chart.marks(places.map(|(i, e)| (*e, (i as f64 + 0.5) / RUNS as f64)), index)?;
        }
        chart.write("as stated", (14.0, 0.62), letters_right_of(SERIES[0]))?;
        chart.write("understated", (80.0, 0.52), letters_right_of(SERIES[1]))?;
        chart.write("95 %", (33.0, 0.94), letters_around(INK))
    })
}
