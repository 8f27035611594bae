//! How normalized errors are distributed, and how they should be.

use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;

use crate::bundle_adjustment::consistency::{
    DEGREES, OUTSIDE_RUN, band, chi_square_below, chi_square_quantile, errors,
};
use crate::figure::{self, Figure, GRID, INK, SERIES, letters_around, letters_right_of, marker};

const RUNS: usize = 120;
/// Pixels of noise where one is stated.
const NOISES: [f64; 2] = [1.0, 1.3];
const SHARES: [f64; 19] = [
    0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85,
    0.9, 0.95,
];

pub fn consistency() -> Figure {
    let sorted = NOISES.map(|noise| {
        let mut errors = errors(RUNS, noise);
        errors.sort_by(f64::total_cmp);
        errors
    });
    let of_share = |errors: &[f64], share: f64| errors[(share * RUNS as f64) as usize];
    let rows = SHARES.map(|share| {
        vec![
            format!("{share:.2}"),
            format!("{:.1}", chi_square_quantile(share, DEGREES)),
            format!("{:.1}", of_share(&sorted[0], share)),
            format!("{:.1}", of_share(&sorted[1], share)),
        ]
    });
    Figure {
        columns: vec![
            "share of runs below",
            "chi-square of 41 degrees of freedom",
            "normalized error with the noise as stated",
            "with 1.3 px where 1 px is stated",
        ],
        rows: rows.to_vec(),
        svg: figure::draw(780, |drawing| {
            let x_axis = ("normalized error of a run", 10.0..112.0, 6);
            let mut chart = figure::axes(drawing, x_axis, ("share of runs below", 0.0..1.0, 5))?;
            for end in band(OUTSIDE_RUN, DEGREES) {
                let line = [(end, 0.0), (end, 1.0)];
                chart.draw_series([PathElement::new(line, GRID.stroke_width(6))])?;
            }
            let curve = (0..=200).map(|step| 10.0 + 0.51 * f64::from(step));
            let curve = curve.map(|x| (x, chi_square_below(x, DEGREES)));
            chart.draw_series(LineSeries::new(curve, INK.stroke_width(5)))?;
            for (index, errors) in sorted.iter().enumerate() {
                let places = errors.iter().enumerate().skip(1).step_by(4);
                let places = places.map(|(i, error)| (*error, (i as f64 + 0.5) / RUNS as f64));
                let marks = places.map(|place| EmptyElement::at(place) + marker(index));
                chart.draw_series(marks)?;
            }
            let as_stated = Text::new("as stated", (14.0, 0.62), letters_right_of(SERIES[0]));
            let understated = Text::new("understated", (80.0, 0.52), letters_right_of(SERIES[1]));
            chart.draw_series([as_stated, understated])?;
            chart.draw_series([Text::new("95 %", (33.0, 0.94), letters_around(INK))])?;
            Ok(())
        }),
    }
}
