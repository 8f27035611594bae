//! The figures of the chapter.

mod bent;
mod digits;
mod faults;
mod hover;
mod nees;
mod sigmas;
mod spot;

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2};

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("spot", spot::spot);
    chapter.figure("sigmas", sigmas::sigmas);
    chapter.figure("bent", bent::bent);
    chapter.figure("digits", digits::digits);
    chapter.figure("nees", nees::nees);
    chapter.figure("faults", faults::faults);
    chapter.figure("hover", hover::hover);
}

/// The points of an ellipse of one standard deviation.
fn ellipse(centre: &Vector2<f64>, covariance: &Matrix2<f64>) -> Vec<(f64, f64)> {
    let root = covariance.cholesky().expect("a covariance").l();
    let point = |k: u32| {
        let (sine, cosine) = (TAU * f64::from(k) / 120.0).sin_cos();
        let at = centre + root * Vector2::new(cosine, sine);
        (at.x, at.y)
    };
    (0..=120).map(point).collect()
}
