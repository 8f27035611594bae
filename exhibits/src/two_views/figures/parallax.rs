//! What the angle between two rays decides.

use plotters::coord::combinators::IntoLogRange;
use vislam::two_views::{point_condition, ray_sigma};

use crate::figure::{self, Draw, Figure, SERIES, decimals};
use crate::two_views::draws::{Draws, rms_error};
use crate::two_views::oracle::information;
use crate::two_views::worked::{CAMERA, facing};

/// Degrees.
const ANGLES: [f64; 8] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 45.0, 90.0];
/// Metres from both cameras to the point.
const DISTANCE: f64 = 5.0;
const PAIRS: usize = 1000;
const SEED: u64 = 62;

/// Percent, to first order, at an angle in degrees.
fn error(angle: f64) -> f64 {
    100.0 * ray_sigma(1.0, 1.0, angle.to_radians(), 1.0 / CAMERA.fx)
}

fn condition(angle: f64) -> f64 {
    point_condition(angle.to_radians())
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
    let (errors, conditions) = (measured.map(|of| of.0), measured.map(|of| of.1));
    let columns = vec![
        ("parallax (degrees)", ANGLES.map(|angle| angle.to_string()).to_vec()),
        ("depth error to first order (%)", decimals(3, ANGLES.map(error))),
        ("scatter of noisy draws (%)", decimals(3, errors)),
        ("condition number by the formula", decimals(1, ANGLES.map(condition))),
        ("condition number of the information", decimals(1, conditions)),
    ];
    let angles = || (0.4..110.0).log_scale();
    let curve = || (0..=100).map(|step| 0.5 * 180.0_f64.powf(f64::from(step) / 100.0));
    Figure::new(1240, columns, |drawing| {
        let (above, below) = drawing.split_vertically(600);
        let y_axis = ("depth error (%)", (0.1..100.0).log_scale(), 4);
        let mut chart = figure::axes(&above, ("", angles(), 3), y_axis)?;
        chart.line(curve().map(|angle| (angle, error(angle))), SERIES[0], 5)?;
        let shown = ANGLES.into_iter().zip(errors).filter(|(_, error)| *error < 100.0);
        chart.marks(shown, 0)?;
        let y_axis = ("condition number", (1.0..100_000.0).log_scale(), 6);
        let mut chart = figure::axes(&below, ("parallax (degrees)", angles(), 3), y_axis)?;
        chart.line(curve().map(|angle| (angle, condition(angle))), SERIES[1], 5)?;
        chart.marks(ANGLES.into_iter().zip(conditions), 1)
    })
}
