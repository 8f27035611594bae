//! What the angle between two rays decides.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::EmptyElement;
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::two_views::{point_condition, ray_sigma};

use crate::figure::{self, Figure, SERIES, marker};
use crate::two_views::draws::{Draws, rms_error};
use crate::two_views::oracle::information;
use crate::two_views::worked::{CAMERA, facing};

/// Degrees.
const ANGLES: [f64; 8] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 45.0, 90.0];
/// Metres from both cameras to the point.
const DISTANCE: f64 = 5.0;
const PAIRS: usize = 1000;
const SEED: u64 = 62;

/// Percent, to first order, and condition number, at an angle in degrees.
fn formulas(angle: f64) -> (f64, f64) {
    let parallax = angle.to_radians();
    (100.0 * ray_sigma(1.0, 1.0, parallax, 1.0 / CAMERA.fx), point_condition(parallax))
}

/// The same two from noisy pixels and from differences of the projections.
fn measured(angle: f64) -> (f64, f64) {
    let (point, views) = facing(DISTANCE, angle.to_radians());
    let draws = Draws::of(&views, PAIRS, SEED);
    let eigenvalues = information(&views, &point).symmetric_eigenvalues();
    let scatter = rms_error(&draws.likely, &point, 2);
    (100.0 * scatter / DISTANCE, eigenvalues.max() / eigenvalues.min())
}

pub fn parallax() -> Figure {
    let measured = ANGLES.map(measured);
    let rows = ANGLES.iter().zip(&measured).map(|(angle, (scatter, of_information))| {
        let (error, condition) = formulas(*angle);
        vec![
            format!("{angle}"),
            format!("{error:.3}"),
            format!("{scatter:.3}"),
            format!("{condition:.1}"),
            format!("{of_information:.1}"),
        ]
    });
    Figure {
        columns: vec![
            "parallax (degrees)",
            "depth error to first order (%)",
            "scatter of noisy draws (%)",
            "condition number by the formula",
            "condition number of the information",
        ],
        rows: rows.collect(),
        svg: draw(&measured),
    }
}

fn draw(measured: &[(f64, f64); ANGLES.len()]) -> String {
    let angles = || (0.4..110.0).log_scale();
    let curve = || (0..=100).map(|step| 0.5 * 180.0_f64.powf(f64::from(step) / 100.0));
    figure::draw(1240, |drawing| {
        let (above, below) = drawing.split_vertically(600);
        let errors = ("depth error (%)", (0.1..100.0).log_scale(), 4);
        let mut chart = figure::axes(&above, ("", angles(), 3), errors)?;
        let line = curve().map(|angle| (angle, formulas(angle).0));
        chart.draw_series(LineSeries::new(line, SERIES[0].stroke_width(5)))?;
        let marks = ANGLES.into_iter().zip(measured.map(|(error, _)| error));
        let shown = marks.filter(|(_, error)| *error < 100.0);
        chart.draw_series(shown.map(|place| EmptyElement::at(place) + marker(0)))?;
        let conditions = ("condition number", (1.0..100_000.0).log_scale(), 6);
        let mut chart = figure::axes(&below, ("parallax (degrees)", angles(), 3), conditions)?;
        let line = curve().map(|angle| (angle, formulas(angle).1));
        chart.draw_series(LineSeries::new(line, SERIES[1].stroke_width(5)))?;
        let marks = ANGLES.into_iter().zip(measured.map(|(_, condition)| condition));
        chart.draw_series(marks.map(|place| EmptyElement::at(place) + marker(1)))?;
        Ok(())
    })
}
