//! The other convention.

use exercise_spec::left_perturbation::{Camera, Side};
use nalgebra::{Isometry3, Matrix2x6, Point3, Vector2, Vector3, Vector6};
use vislam::manifold::{se3, so3};

/// The derivative of the pixel of a world point by a twist ξ = (ρ, φ) that moves the pose on
/// the **left**, exp(ξ) T, at ξ = 0. In pixels per metre and per radian. The point is in
/// front of the camera.
pub fn left_pose_jacobian(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    point_in_world: Vector3<f64>,
) -> Matrix2x6<f64> {
    let point_in_camera = (camera_from_world * Point3::from(point_in_world)).coords;
    let mut jacobian = Matrix2x6::zeros();
    if let Some(projection) = camera.pinhole().projection_jacobian(&point_in_camera) {
        jacobian.fixed_columns_mut::<3>(0).copy_from(&projection);
        jacobian.fixed_columns_mut::<3>(3).copy_from(&(-projection * so3::hat(&point_in_camera)));
    }
    jacobian
}

/// The derivative by a twist on the **right** of the pose, T exp(ξ), of something whose
/// derivative by a twist on the left is given.
pub fn right_from_left(camera_from_world: Isometry3<f64>, left: Matrix2x6<f64>) -> Matrix2x6<f64> {
    left * se3::adjoint(&camera_from_world)
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
    let pixel = |axis: usize, step: f64| {
        let mut xi = Vector6::zeros();
        xi[axis] = step;
        let moved = match side {
            Side::Left => se3::exp(&xi) * camera_from_world,
            Side::Right => camera_from_world * se3::exp(&xi),
        };
        camera.pinhole().project(&moved, &point_in_world).unwrap_or_default()
    };
    Matrix2x6::from_columns(
        &[0, 1, 2, 3, 4, 5].map(|axis| (pixel(axis, step) - pixel(axis, -step)) / (2.0 * step)),
    )
}

/// How the pixel of a point moves, in pixels per metre, when the **camera** moves forward
/// along its optical axis. The point is given in the camera's frame and stays where it is in
/// the world.
pub fn forward_motion(camera: Camera, point_in_camera: Vector3<f64>) -> Vector2<f64> {
    let projection = camera.pinhole().projection_jacobian(&point_in_camera).unwrap_or_default();
    -projection.column(2)
}
