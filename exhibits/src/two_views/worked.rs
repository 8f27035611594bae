//! The worked example, the same as in the first chapter, and pairs that look at one point.

use nalgebra::{Isometry3, Rotation3, Vector3};
use vislam::bearing::{depth_sigma, disparity_sigma};
use vislam::reprojection::Pinhole;
use vislam::two_views::View;

use super::NOWHERE;

pub const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

/// Metres from the first camera to the second, along x.
pub const BASELINE: f64 = 0.5;

pub const POINT: Vector3<f64> = Vector3::new(0.2, -0.1, 5.0);

/// The point on the worked point's ray at another depth, in metres.
pub fn point_at(depth: f64) -> Vector3<f64> {
    depth / POINT.z * POINT
}

/// Standard deviation of a depth to first order, with a pixel of noise in both images.
pub fn depth_sigma_of(baseline: f64, depth: f64) -> f64 {
    depth_sigma(&CAMERA, baseline, depth, disparity_sigma(1.0, 1.0))
}

/// The motion from the first camera to one that stands `baseline` metres to its right.
pub fn second_from_first(baseline: f64) -> Isometry3<f64> {
    Isometry3::translation(-baseline, 0.0, 0.0)
}

/// What the camera sees of a point without noise; it claims one pixel of noise.
pub fn view(camera_from_world: Isometry3<f64>, point: &Vector3<f64>) -> View {
    let pixel = CAMERA.project(&camera_from_world, point).unwrap_or(NOWHERE);
    View { camera: CAMERA, camera_from_world, pixel, sigma: 1.0 }
}

/// Two cameras side by side that look the same way.
pub fn side_by_side(point: &Vector3<f64>, baseline: f64) -> [View; 2] {
    [0.0, baseline].map(|baseline| view(second_from_first(baseline), point))
}

/// Two cameras at the same distance from a point in the middle of both pictures, whose rays meet
/// there at an angle. The first one stands at the origin.
pub fn facing(distance: f64, parallax: f64) -> (Vector3<f64>, [View; 2]) {
    let point = distance * Vector3::z();
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), parallax);
    let second = Isometry3::from_parts((point - turn * point).into(), turn.into());
    (point, [Isometry3::identity(), second].map(|pose| view(pose, &point)))
}

/// A robot that drives towards a point a little off its way: six cameras in a row, the first far
/// from the point and the last near.
pub fn approach() -> (Vector3<f64>, [View; 6]) {
    let point = Vector3::new(0.8, -0.3, 22.0);
    let views = std::array::from_fn(|index| {
        view(Isometry3::translation(0.0, 0.0, -4.0 * index as f64), &point)
    });
    (point, views)
}
