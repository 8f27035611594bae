//! What the chapter's theorems say falsely where one of their conditions is dropped.

use nalgebra::{Isometry3, Rotation3, Vector3};

use super::NOWHERE;
use super::worked::{BASELINE, CAMERA, POINT, second_from_first};

/// Pixels that the worked point moves by in the second camera when all points move twice as far away
/// and the cameras stay where they are.
pub fn centres_not_scaled() -> f64 {
    let pose = second_from_first(BASELINE);
    apart(&pose, [&POINT, &(2.0 * POINT)])
}

/// Pixels between the images of two points of one ray after a turn about a place ten centimetres
/// beside the camera's centre.
pub fn turn_about_another_place() -> f64 {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 10_f64.to_radians());
    let place = Vector3::new(0.1, 0.0, 0.0);
    let pose = Isometry3::from_parts((place - turn * place).into(), turn.into());
    apart(&pose, [&POINT, &(10.0 * POINT)])
}

fn apart(camera_from_world: &Isometry3<f64>, points: [&Vector3<f64>; 2]) -> f64 {
    let [first, second] =
        points.map(|point| CAMERA.project(camera_from_world, point).unwrap_or(NOWHERE));
    (second - first).norm()
}
