//! Sideways or along the ray: what several cameras see of a point that is dragged.

use nalgebra::{Isometry3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

pub use crate::camera::Camera;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: view
/// A camera and where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Takes world coordinates to those of the camera.
    pub camera_from_world: Isometry3<f64>,
}
// ANCHOR_END: view

crate::signatures! {
    // ANCHOR: drags
    /// The drag, in world coordinates and metres, that takes a point straight away from the
    /// centre of camera `seen_from`, along the ray on which that camera sees it. It is
    /// `distance` long.
    fn drag_along(
        views: Vec<View>,
        seen_from: usize,
        point_in_world: Vector3<f64>,
        distance: f64,
    ) -> Vector3<f64>;

    /// The drag, in world coordinates and metres, at right angles both to that ray and to the
    /// y axis of camera `seen_from`. It is `distance` long, and the camera sees the point go
    /// to the right.
    fn drag_across(
        views: Vec<View>,
        seen_from: usize,
        point_in_world: Vector3<f64>,
        distance: f64,
    ) -> Vector3<f64>;
    // ANCHOR_END: drags

    // ANCHOR: moves
    /// How far the pixel of the point moves in each camera, to first order in the drag. The drag
    /// is in world coordinates and metres, the moves are in pixels, new place minus old.
    fn predicted_moves(
        views: Vec<View>,
        point_in_world: Vector3<f64>,
        drag: Vector3<f64>,
    ) -> Vec<Vector2<f64>>;

    /// How far the pixel of the point really moves in each camera. The point is in front of all
    /// of them, before the drag and after it.
    fn exact_moves(
        views: Vec<View>,
        point_in_world: Vector3<f64>,
        drag: Vector3<f64>,
    ) -> Vec<Vector2<f64>>;
    // ANCHOR_END: moves

    // ANCHOR: least
    /// The drag of length one, in world coordinates, that all cameras **together** notice least:
    /// to first order, the sum over all cameras of the squared length of the pixel's move is
    /// smallest. Of the two such drags the one that leads away from camera 0.
    fn least_noticed_drag(views: Vec<View>, point_in_world: Vector3<f64>) -> Vector3<f64>;
    // ANCHOR_END: least
}
