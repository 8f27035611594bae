//! Ways to the chapter's results that do not use its formulas.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use vislam::reprojection::Pinhole;

/// The matrix K that takes a point of the plane z = 1 to its homogeneous pixel.
pub fn calibration(camera: &Pinhole) -> Matrix3<f64> {
    Matrix3::new(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0)
}

/// Pixel of a point in camera coordinates: where the line from the optical centre to the point
/// meets the plane z = 1. The line is given by two planes that contain it. NaN for a point behind
/// the camera.
pub fn image_of(camera: &Pinhole, point: &Vector3<f64>) -> Vector2<f64> {
    let planes = Matrix3::from_rows(&[
        point.cross(&Vector3::x()).transpose(),
        point.cross(&Vector3::y()).transpose(),
        Vector3::z().transpose(),
    ]);
    match planes.lu().solve(&Vector3::z()) {
        Some(meeting) if point.z > 0.0 => (calibration(camera) * meeting).xy(),
        _ => Vector2::repeat(f64::NAN),
    }
}

/// Depth at which the rays of two pixels of the same image row meet; the second camera stands
/// `baseline` metres to the right of the first. NaN when the rays are parallel.
pub fn meeting_depth(camera: &Pinhole, baseline: f64, first_u: f64, second_u: f64) -> f64 {
    let slope = |u: f64| (u - camera.cx) / camera.fx;
    // x - slope z = x of the camera's centre, once for each camera.
    let rays = Matrix2::new(1.0, -slope(first_u), 1.0, -slope(second_u));
    let meeting = rays.lu().solve(&Vector2::new(0.0, baseline));
    meeting.map_or(f64::NAN, |x_and_z| x_and_z.y)
}
