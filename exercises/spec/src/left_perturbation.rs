//! The other convention: derivatives of a pixel by a twist on the left of the pose.

use nalgebra::{Isometry3, Matrix2x6, Vector2, Vector3};
use serde::{Deserialize, Serialize};

pub use crate::camera::Camera;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: side
/// On which side of a pose a twist stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// exp(ξ) T.
    Left,
    /// T exp(ξ), as everywhere else in the book.
    Right,
}
// ANCHOR_END: side

crate::signatures! {
    // ANCHOR: signatures
    /// The derivative of the pixel of a world point by a twist ξ = (ρ, φ) that moves the pose on
    /// the **left**, exp(ξ) T, at ξ = 0. In pixels per metre and per radian. The point is in
    /// front of the camera.
    fn left_pose_jacobian(
        camera: Camera,
        camera_from_world: Isometry3<f64>,
        point_in_world: Vector3<f64>,
    ) -> Matrix2x6<f64>;

    /// The derivative by a twist on the **right** of the pose, T exp(ξ), of something whose
    /// derivative by a twist on the left is given.
    fn right_from_left(camera_from_world: Isometry3<f64>, left: Matrix2x6<f64>) -> Matrix2x6<f64>;
    // ANCHOR_END: signatures

    // ANCHOR: checking
    /// Either derivative by central differences with the step given: in each of the six
    /// directions, half the difference of two pixels over the step. Its error shrinks with the
    /// square of the step.
    fn central_differences(
        camera: Camera,
        camera_from_world: Isometry3<f64>,
        point_in_world: Vector3<f64>,
        side: Side,
        step: f64,
    ) -> Matrix2x6<f64>;

    /// How the pixel of a point moves, in pixels per metre, when the **camera** moves forward
    /// along its optical axis. The point is given in the camera's frame and stays where it is in
    /// the world.
    fn forward_motion(camera: Camera, point_in_camera: Vector3<f64>) -> Vector2<f64>;
    // ANCHOR_END: checking
}
