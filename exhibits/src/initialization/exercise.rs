//! A body that was leveled with a bias in its accelerometer and is turned on the spot: numbers of the exercise on
//! gravity.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::GRAVITY;

use crate::chapter::Chapter;

/// The bias along the body's first axis, in m/s².
const BIAS: f64 = 0.1;
/// How long the body stands after the turn, in seconds.
const SECONDS: f64 = 10.0;

/// The acceleration in the world that a standing body believes in, after it was leveled by its mean force and
/// turned about the vertical by an angle that it knows.
fn believed(bias: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    let upwards = -GRAVITY;
    let force = upwards + bias;
    let leveled = Rotation3::rotation_between(&force, &upwards).unwrap_or_default();
    let turned = Rotation3::new(angle * Vector3::z());
    // The body stood upright, so its readings after the turn are what they were.
    leveled * turned * force + GRAVITY
}

pub fn numbers(chapter: &mut Chapter) {
    let bias = BIAS * Vector3::x();
    let tilt = (-GRAVITY).angle(&(bias - GRAVITY));
    let level = |angle: f64| believed(&bias, angle).xy().norm();
    let half = level(std::f64::consts::PI);
    chapter.number("exercise_bias", BIAS, "m/s²", 1);
    chapter.number("exercise_tilt", tilt.to_degrees(), "°", 1);
    chapter.number("exercise_before", level(0.0), "m/s²", 1);
    chapter.number("exercise_after", half, "m/s²", 1);
    chapter.number("exercise_seconds", SECONDS, "s", 0);
    chapter.number("exercise_away", 0.5 * half * SECONDS * SECONDS, "m", 0);
}
