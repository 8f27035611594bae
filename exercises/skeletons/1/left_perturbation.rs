//! The other convention. Edition 1.
//!
//! `cargo test -p exercises left_perturbation`

use exercise_spec::left_perturbation::{Camera, Side};
use nalgebra::{Isometry3, Matrix2x6, Vector2, Vector3};

/// The derivative of the pixel of a world point by a twist ξ = (ρ, φ) that moves the pose on
/// the **left**, exp(ξ) T, at ξ = 0. In pixels per metre and per radian. The point is in
/// front of the camera.
pub fn left_pose_jacobian(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    point_in_world: Vector3<f64>,
) -> Matrix2x6<f64> {
    let _ = (camera, camera_from_world, point_in_world);
    todo!("two blocks: how ρ moves the pixel, and how φ does")
}

/// The derivative by a twist on the **right** of the pose, T exp(ξ), of something whose
/// derivative by a twist on the left is given.
pub fn right_from_left(camera_from_world: Isometry3<f64>, left: Matrix2x6<f64>) -> Matrix2x6<f64> {
    let _ = (camera_from_world, left);
    todo!("the dictionary between the two sides")
}

/// Either derivative by central differences with the step given: in each of the six
/// directions, half the difference of two pixels over the step. Its error shrinks with the
/// square of the step.
pub fn central_differences(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    point_in_world: Vector3<f64>,
    side: Side,
    step: f64,
) -> Matrix2x6<f64> {
    let _ = (camera, camera_from_world, point_in_world, side, step);
    todo!("one column for each axis of the twist")
}

/// How the pixel of a point moves, in pixels per metre, when the **camera** moves forward
/// along its optical axis. The point is given in the camera's frame and stays where it is in
/// the world.
pub fn forward_motion(camera: Camera, point_in_camera: Vector3<f64>) -> Vector2<f64> {
    let _ = (camera, point_in_camera);
    todo!("the camera goes forward; where does the point go?")
}
