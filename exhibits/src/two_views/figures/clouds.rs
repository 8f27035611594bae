//! Linear and most likely points of a robot that drives towards them, from above.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use plotters::element::Circle;
use plotters::style::{Color, RGBColor};
use vislam::two_views::triangulate_nonlinear;

use crate::figure::{self, Draw, Drawing, Drawn, ESTIMATED, Figure, INK, decimals, letters_around};
use crate::two_views::draws::{Draws, on_the_drive, rms_error};
use crate::two_views::worked::approach;

/// How many errors are shown.
const DOTS: usize = 300;
/// Standard deviations at which an ellipse holds 95 % of a plane normal distribution.
pub const NINETY_FIVE: f64 = 2.4477;

pub fn clouds() -> Figure {
    let (point, views) = approach();
    let Draws { linear, likely, .. } = on_the_drive();
    let found = triangulate_nonlinear(&views, &point).expect("pixels without noise have a point");
    // Depth to the right and the side up, as the picture has them.
    let c = found.covariance;
    let plane = Matrix2::new(c.m33, c.m13, c.m13, c.m11);
    let inverse = plane.try_inverse().expect("the depth is known");
    let scatter = |axis| [linear, likely].map(|points| 100.0 * rms_error(points, &point, axis));
    let inside = [linear, likely].map(|points| {
        let errors = points.iter().map(|found| error_in_plane(found, &point));
        let inside = errors.filter(|error| error.dot(&(inverse * error)) < NINETY_FIVE.powi(2));
        100.0 * inside.count() as f64 / points.len() as f64
    });
    let columns = vec![
        ("point", ["linear", "most likely"].map(str::to_owned).to_vec()),
        ("scatter in depth (cm)", decimals(1, scatter(2))),
        ("scatter to the side (cm)", decimals(1, scatter(0))),
        ("share inside the ellipse of the covariance (%)", decimals(1, inside)),
    ];
    Figure::new(720, columns, |drawing| {
        let (left, right) = drawing.split_horizontally(690);
        let outline = ellipse(&plane);
        let side = ("error to the side (cm)", 5);
        panel(&left, linear, &point, &outline, ("linear", INK), side)?;
        panel(&right, likely, &point, &outline, ("most likely", ESTIMATED), ("", 0))
    })
}

/// Error in depth and to the side, in metres.
fn error_in_plane(found: &Vector3<f64>, truth: &Vector3<f64>) -> Vector2<f64> {
    (found - truth).zx()
}

/// The ellipse that should hold 95 % of all errors, in centimetres.
fn ellipse(covariance: &Matrix2<f64>) -> Vec<(f64, f64)> {
    let SymmetricEigen { eigenvectors, eigenvalues } = covariance.symmetric_eigen();
    let around = (0..=120).map(|step| {
        let angle = std::f64::consts::TAU * f64::from(step) / 120.0;
        let circle = Vector2::new(angle.cos(), angle.sin());
        let place = eigenvectors * eigenvalues.map(f64::sqrt).component_mul(&circle);
        (100.0 * NINETY_FIVE * place.x, 100.0 * NINETY_FIVE * place.y)
    });
    around.collect()
}

fn panel(
    drawing: &Drawing,
    points: &[Vector3<f64>],
    truth: &Vector3<f64>,
    outline: &[(f64, f64)],
    (name, colour): (&str, RGBColor),
    (side, ticks): (&str, usize),
) -> Drawn {
    let depth = ("error in depth (cm)", -21.0..21.0, 5);
    let mut chart = figure::axes(drawing, depth, (side, -7.0..7.0, ticks))?;
    chart.draw_series(points.iter().take(DOTS).filter_map(|found| {
        let error = 100.0 * error_in_plane(found, truth);
        let is_shown = error.x.abs() < 21.0 && error.y.abs() < 7.0;
        is_shown.then(|| Circle::new((error.x, error.y), 5, colour.mix(0.45).filled()))
    }))?;
    chart.line(outline.iter().copied(), INK, 5)?;
    chart.write(name, (-11.0, 6.2), letters_around(colour))
}
