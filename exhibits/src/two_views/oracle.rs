//! Ways to the chapter's results that do not use its formulas.

use nalgebra::{Isometry3, Matrix2, Matrix3, Vector2, Vector3};
use vislam::reprojection::Pinhole;
use vislam::two_views::View;

use crate::comparison::differences;

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

/// The views with their pixels moved by so many standard deviations, two numbers for each view.
pub fn nudged<const N: usize>(views: &[View; N], by: &[f64]) -> [View; N] {
    std::array::from_fn(|index| {
        let View { pixel, sigma, .. } = views[index];
        View {
            pixel: pixel + sigma * Vector2::new(by[2 * index], by[2 * index + 1]),
            ..views[index]
        }
    })
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
        let pixel = |step| seen(&view.camera, &view.camera_from_world, &(point + step));
        let jacobian = differences(1e-5 * point.norm(), pixel) / view.sigma;
        jacobian.tr_mul(&jacobian)
    };
    views.iter().map(of_view).sum()
}
