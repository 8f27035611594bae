//! Ways to the chapter's results that do not use its formulas.

use nalgebra::{Isometry3, Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};
use vislam::reprojection::Pinhole;
use vislam::two_views::View;

/// Pixel of a point of the world by matrices of homogeneous coordinates; NaN behind the camera.
pub fn seen(
    camera: &Pinhole,
    camera_from_world: &Isometry3<f64>,
    point: &Vector3<f64>,
) -> Vector2<f64> {
    let calibration =
        Matrix3::new(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
    let in_camera = (camera_from_world.to_homogeneous() * point.push(1.0)).xyz();
    let homogeneous = calibration * in_camera;
    if in_camera.z > 0.0 { homogeneous.xy() / homogeneous.z } else { Vector2::repeat(f64::NAN) }
}

/// Derivative of a function of one variable with values in space.
pub fn slope(function: impl Fn(f64) -> Vector3<f64>, step: f64) -> Vector3<f64> {
    (function(step) - function(-step)) / (2.0 * step)
}

/// Second derivative of such a function.
pub fn curvature(function: impl Fn(f64) -> Vector3<f64>, step: f64) -> Vector3<f64> {
    (function(step) - 2.0 * function(0.0) + function(-step)) / (step * step)
}

/// The views with one coordinate of one pixel moved by `change` standard deviations. Coordinates
/// are counted through all views, two in each.
pub fn nudged<const N: usize>(views: &[View; N], coordinate: usize, change: f64) -> [View; N] {
    let mut moved = *views;
    let view = &mut moved[coordinate / 2];
    view.pixel[coordinate % 2] += change * view.sigma;
    moved
}

/// Where two rays of a plane meet. The first starts at the origin, the second at `(x, z)`; angles
/// are measured from the z axis towards x.
pub fn meeting_in_plane(first_angle: f64, second_angle: f64, start: Vector2<f64>) -> Vector2<f64> {
    let [first, second] =
        [first_angle, second_angle].map(|angle| Vector2::new(angle.sin(), angle.cos()));
    let rays = Matrix2::from_columns(&[first, -second]);
    let lengths = rays.lu().solve(&start).unwrap_or(Vector2::repeat(f64::NAN));
    lengths.x * first
}

/// The information about a point, by central differences.
pub fn information<const N: usize>(views: &[View; N], point: &Vector3<f64>) -> Matrix3<f64> {
    let of_view = |view: &View| {
        let pixel = |axis: usize, step: f64| -> Vector2<f64> {
            let moved = point + step * Vector3::ith(axis, 1.0);
            seen(&view.camera, &view.camera_from_world, &moved)
        };
        let step = 1e-5 * point.norm();
        let columns = [0, 1, 2].map(|axis| (pixel(axis, step) - pixel(axis, -step)) / (2.0 * step));
        let jacobian = Matrix2x3::from_columns(&columns) / view.sigma;
        jacobian.tr_mul(&jacobian)
    };
    views.iter().map(of_view).sum()
}
