//! A tenth of the matches is wrong. Edition 1.
//!
//! `cargo test -p exercises outlier_rescue`

use exercise_spec::outlier_rescue::{Camera, Match};
use nalgebra::{Isometry3, Matrix2, Vector2, Vector6};

/// The weight w = ρ'(s)/s of Huber's kernel for a residual given in **pixels** with its
/// covariance in square pixels. s is the length of the whitened residual. The threshold
/// counts standard deviations and is positive; an infinite one gives every match the weight
/// one, and so does any threshold to a residual of zero.
pub fn huber_weight(residual: Vector2<f64>, covariance: Matrix2<f64>, threshold: f64) -> f64 {
    let _ = (residual, covariance, threshold);
    todo!("how many of its own standard deviations is the residual long, and what is that worth?")
}

/// One reweighted Gauss-Newton step: the twist ξ = (ρ, φ), in metres and radians, to be
/// applied on the **right**, T exp(ξ). It is the minimum of the sum of weighted squares of
/// the whitened, linearized residuals, with the weights of the pose given. Every point is in
/// front of the camera, and the matches determine the pose.
pub fn robust_step(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    matches: Vec<Match>,
    threshold: f64,
) -> Vector6<f64> {
    let _ = (camera, camera_from_world, matches, threshold);
    todo!("the minimum of the weighted squares of all matches, linearized at this pose")
}

/// The pose with the least sum of Huber's costs, near the pose to start from: steps until
/// the length of their six numbers is below 1e-10. An infinite threshold makes it the pose
/// of least squares.
pub fn robust_pose(
    camera: Camera,
    start: Isometry3<f64>,
    matches: Vec<Match>,
    threshold: f64,
) -> Isometry3<f64> {
    let _ = (camera, start, matches, threshold);
    todo!("steps, until they are shorter than 1e-10")
}

/// The root of the mean square of the residuals' **coordinates**, in pixels, over the right
/// matches: a match has two coordinates, and `right` says of each match whether it is right.
/// At least one is.
pub fn rmse_of_right(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    matches: Vec<Match>,
    right: Vec<bool>,
) -> f64 {
    let _ = (camera, camera_from_world, matches, right);
    todo!("one number for both coordinates of all matches that are right")
}
