//! Wrong matches: Huber's kernel on whitened residuals, for the pose of one camera.

use nalgebra::{Isometry3, Matrix2, Vector2, Vector3, Vector6};
use serde::{Deserialize, Serialize};

pub use crate::camera::Camera;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: matched
/// A known point and the pixel where it is believed to have been seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Match {
    /// The point, in metres.
    pub point_in_world: Vector3<f64>,
    /// The pixel.
    pub pixel: Vector2<f64>,
    /// What a right pixel's noise is like: its 2×2 covariance in square pixels, different from
    /// match to match and from direction to direction.
    pub covariance: Matrix2<f64>,
}
// ANCHOR_END: matched

crate::signatures! {
    // ANCHOR: signatures
    /// The weight w = ρ'(s)/s of Huber's kernel for a residual given in **pixels** with its
    /// covariance in square pixels. s is the length of the whitened residual. The threshold
    /// counts standard deviations and is positive; an infinite one gives every match the weight
    /// one, and so does any threshold to a residual of zero.
    fn huber_weight(residual: Vector2<f64>, covariance: Matrix2<f64>, threshold: f64) -> f64;

    /// One reweighted Gauss-Newton step: the twist ξ = (ρ, φ), in metres and radians, to be
    /// applied on the **right**, T exp(ξ). It is the minimum of the sum of weighted squares of
    /// the whitened, linearized residuals, with the weights of the pose given. Every point is in
    /// front of the camera, and the matches determine the pose.
    fn robust_step(
        camera: Camera,
        camera_from_world: Isometry3<f64>,
        matches: Vec<Match>,
        threshold: f64,
    ) -> Vector6<f64>;
    // ANCHOR_END: signatures

    // ANCHOR: rescuing
    /// The pose with the least sum of Huber's costs, near the pose to start from: steps until
    /// the length of their six numbers is below 1e-10. An infinite threshold makes it the pose
    /// of least squares.
    fn robust_pose(
        camera: Camera,
        start: Isometry3<f64>,
        matches: Vec<Match>,
        threshold: f64,
    ) -> Isometry3<f64>;

    /// The root of the mean square of the residuals' **coordinates**, in pixels, over the right
    /// matches: a match has two coordinates, and `right` says of each match whether it is right.
    /// At least one is.
    fn rmse_of_right(
        camera: Camera,
        camera_from_world: Isometry3<f64>,
        matches: Vec<Match>,
        right: Vec<bool>,
    ) -> f64;
    // ANCHOR_END: rescuing
}
