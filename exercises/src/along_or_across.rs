//! Sideways or along the ray. Edition 1.
//!
//! `cargo test -p exercises along_or_across`

use exercise_spec::along_or_across::View;
use nalgebra::{Vector2, Vector3};

/// The drag, in world coordinates and metres, that takes a point straight away from the
/// centre of camera `seen_from`, along the ray on which that camera sees it. It is
/// `distance` long.
pub fn drag_along(
    views: Vec<View>,
    seen_from: usize,
    point_in_world: Vector3<f64>,
    distance: f64,
) -> Vector3<f64> {
    let _ = (views, seen_from, point_in_world, distance);
    todo!("the ray of that camera, in the world")
}

/// The drag, in world coordinates and metres, at right angles both to that ray and to the
/// y axis of camera `seen_from`. It is `distance` long, and the camera sees the point go
/// to the right.
pub fn drag_across(
    views: Vec<View>,
    seen_from: usize,
    point_in_world: Vector3<f64>,
    distance: f64,
) -> Vector3<f64> {
    let _ = (views, seen_from, point_in_world, distance);
    todo!("square to the ray and to the y axis of that camera, in the world")
}

/// How far the pixel of the point moves in each camera, to first order in the drag. The drag
/// is in world coordinates and metres, the moves are in pixels, new place minus old.
pub fn predicted_moves(
    views: Vec<View>,
    point_in_world: Vector3<f64>,
    drag: Vector3<f64>,
) -> Vec<Vector2<f64>> {
    let _ = (views, point_in_world, drag);
    todo!("for each camera, a move in proportion to the drag")
}

/// How far the pixel of the point really moves in each camera. The point is in front of all
/// of them, before the drag and after it.
pub fn exact_moves(
    views: Vec<View>,
    point_in_world: Vector3<f64>,
    drag: Vector3<f64>,
) -> Vec<Vector2<f64>> {
    let _ = (views, point_in_world, drag);
    todo!("for each camera, where the pixel is after the drag, and where it was")
}

/// The drag of length one, in world coordinates, that all cameras **together** notice least:
/// to first order, the sum over all cameras of the squared length of the pixel's move is
/// smallest. Of the two such drags the one that leads away from camera 0.
pub fn least_noticed_drag(views: Vec<View>, point_in_world: Vector3<f64>) -> Vector3<f64> {
    let _ = (views, point_in_world);
    todo!("one matrix for all cameras, and its weakest direction")
}
