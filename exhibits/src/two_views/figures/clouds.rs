//! Linear and most likely points of a robot that drives towards them, from above.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use plotters::element::{Circle, PathElement, Text};
use plotters::style::{Color, RGBColor};
use vislam::two_views::triangulate_nonlinear;

use crate::figure::{self, Drawing, Drawn, ESTIMATED, Figure, INK, letters_around};
use crate::two_views::draws::{Draws, rms_error};
use crate::two_views::worked::approach;

const PAIRS: usize = 400;
const SEED: u64 = 61;
/// How many errors are shown.
const DOTS: usize = 300;
/// Standard deviations at which an ellipse holds 95 % of a plane normal distribution.
pub const NINETY_FIVE: f64 = 2.4477;

pub fn clouds() -> Figure {
    let (point, views) = approach();
    let draws = Draws::of(&views, PAIRS, SEED);
    let covariance = triangulate_nonlinear(&views, &point).map(|found| found.covariance);
    // Depth to the right and the side up, as the picture has them.
    let plane = covariance.map(|c| Matrix2::new(c.m33, c.m13, c.m13, c.m11));
    let plane = plane.unwrap_or(Matrix2::repeat(f64::NAN));
    let inverse = plane.try_inverse().unwrap_or(Matrix2::repeat(f64::NAN));
    let rows = [("linear", &draws.linear), ("most likely", &draws.likely)].map(|(name, points)| {
        let inside = points.iter().filter(|found| {
            let error = error_in_plane(found, &point);
            error.dot(&(inverse * error)) < NINETY_FIVE * NINETY_FIVE
        });
        vec![
            name.to_owned(),
            format!("{:.1}", 100.0 * rms_error(points, &point, 2)),
            format!("{:.1}", 100.0 * rms_error(points, &point, 0)),
            format!("{:.1}", 100.0 * inside.count() as f64 / points.len() as f64),
        ]
    });
    Figure {
        columns: vec![
            "point",
            "scatter in depth (cm)",
            "scatter to the side (cm)",
            "share inside the ellipse of the covariance (%)",
        ],
        rows: rows.to_vec(),
        svg: figure::draw(720, |drawing| {
            let (left, right) = drawing.split_horizontally(690);
            let outline = ellipse(&plane);
            let side = ("error to the side (cm)", 5);
            panel(&left, &draws.linear, &point, &outline, ("linear", INK), side)?;
            let likely = ("most likely", ESTIMATED);
            panel(&right, &draws.likely, &point, &outline, likely, ("", 0))
        }),
    }
}

/// Error in depth and to the side, in metres.
fn error_in_plane(found: &Vector3<f64>, truth: &Vector3<f64>) -> Vector2<f64> {
    Vector2::new(found.z - truth.z, found.x - truth.x)
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
    chart.draw_series([PathElement::new(outline.to_vec(), INK.stroke_width(5))])?;
    chart.draw_series([Text::new(name.to_owned(), (-11.0, 6.2), letters_around(colour))])?;
    Ok(())
}
