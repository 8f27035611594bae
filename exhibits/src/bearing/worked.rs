//! The worked example that runs through the chapter: two cameras side by side and a point five
//! metres ahead.

use nalgebra::{Isometry3, Vector3};
use vislam::reprojection::Pinhole;

pub const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

/// Metres from the first camera to the second, along x.
pub const BASELINE: f64 = 0.5;

pub const POINT: Vector3<f64> = Vector3::new(0.2, -0.1, 5.0);

/// The motion from the first camera to one that stands `baseline` metres to its right.
pub fn second_from_first(baseline: f64) -> Isometry3<f64> {
    Isometry3::translation(-baseline, 0.0, 0.0)
}
