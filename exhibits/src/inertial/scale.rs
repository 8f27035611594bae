//! What a sensor costs whose axes are not quite to scale and not quite at right angles.

use nalgebra::Matrix3;
use vislam::inertial::{GRAVITY, ImuSample};

use super::noise::STEP;
use super::rules::{DURATION, error_with};
use crate::chapter::Chapter;

/// Error of a scale, and the angle in degrees by which an axis leans.
const SCALE: f64 = 1e-3;
const LEAN_DEG: f64 = 0.05;

pub fn numbers(chapter: &mut Chapter) {
    let lean = LEAN_DEG.to_radians();
    chapter.number("scale_percent", 1e2 * SCALE, "%", 1);
    chapter.number("lean_deg", LEAN_DEG, "°", 2);
    chapter.number("scale_turn_deg", 360.0 * SCALE, "°", 2);
    chapter.number("lean_turn_deg", 360.0 * lean, "°", 2);
    chapter.number("lean_level", 100.0 * GRAVITY.norm() * lean, "cm/s²", 1);
    chapter.number("scale_seconds", DURATION, "s", 0);
    let scaled = Matrix3::from_diagonal_element(1.0 + SCALE);
    let leaning = Matrix3::new(1.0, lean, lean, lean, 1.0, lean, lean, lean, 1.0);
    chapter.number("scale_eight_cm", 100.0 * drifted(&scaled), "cm", 0);
    chapter.number("lean_eight_cm", 100.0 * drifted(&leaning), "cm", 0);
}

/// How far the figure-eight is missed whose readings have gone through the matrix, in metres.
fn drifted(matrix: &Matrix3<f64>) -> f64 {
    error_with(1.0 / STEP, true, |sample| ImuSample {
        gyro: matrix * sample.gyro,
        accelerometer: matrix * sample.accelerometer,
    })
}
