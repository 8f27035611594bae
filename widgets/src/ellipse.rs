//! The picture of a covariance.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2};

const PARTS: u8 = 48;

/// A line around zero at one standard deviation, in the unit of the covariance's root; no places if it is none.
pub fn ellipse(covariance: &Matrix2<f64>) -> Vec<[f64; 2]> {
    let Some(root) = covariance.cholesky() else { return Vec::new() };
    let place = |part: u8| {
        let angle = TAU * f64::from(part) / f64::from(PARTS);
        let place = root.l_dirty().lower_triangle() * Vector2::new(angle.cos(), angle.sin());
        [place.x, place.y]
    };
    (0..=PARTS).map(place).collect()
}
