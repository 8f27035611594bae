//! The chapter's theorems, tried with their conditions and without them.

use nalgebra::{Isometry3, Rotation3, Vector3};
use vislam::bearing::{bearing, transfer_by_infinite_homography};

use super::NOWHERE;
use super::worked::{BASELINE, CAMERA, POINT};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

/// Registers the counterexamples.
pub fn counterexamples(chapter: &mut Chapter) {
    chapter.counterexample("depth", "in-front", pixel_of_a_multiple, [3.0, -1.0]);
    chapter.counterexample("scale", "everything", scaled_world, [(2.0, 2.0), (1.0, 2.0)]);
    chapter.counterexample("scale", "positive", scaled_world, [(2.0, 2.0), (-1.0, -1.0)]);
    chapter.counterexample("rotation", "own-centre", turned_camera, [0.0, 0.2]);
}

/// Whether the bearing of the worked point's pixel leads to the point times `s` as well.
fn pixel_of_a_multiple(s: f64) -> Comparison {
    let pixel = CAMERA.project_cam(&POINT).unwrap_or(NOWHERE);
    let direction = bearing(&CAMERA, &pixel).into_inner();
    let against = Comparison::absolute("the direction to the point", 1e-12, "");
    against.once(direction, (s * POINT).normalize())
}

/// Whether the second camera sees the worked point in the same direction when camera centres and
/// points are multiplied by these.
fn scaled_world((centres, points): (f64, f64)) -> Comparison {
    let centre = BASELINE * Vector3::x();
    let after = (points * POINT - centres * centre).normalize();
    let against = Comparison::absolute("the direction before", 1e-12, "");
    against.once(after, (POINT - centre).normalize())
}

/// Whether the pixel before a turn tells the pixel after it, at two depths, when the camera's centre
/// stands so many metres before the axis of the turn.
fn turned_camera(before_the_axis: f64) -> Comparison {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 10_f64.to_radians());
    let axis = -before_the_axis * Vector3::z();
    let pose = Isometry3::from_parts((axis - turn * axis).into(), turn.into());
    let pixel = CAMERA.project_cam(&POINT).unwrap_or(NOWHERE);
    let told = transfer_by_infinite_homography(&CAMERA, &turn, &pixel);
    let against = Comparison::absolute("the image of the point itself", 1e-9, "px");
    against.each([POINT, 10.0 * POINT], |point| (told, CAMERA.project(&pose, &point)))
}
