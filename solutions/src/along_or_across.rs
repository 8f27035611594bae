//! Sideways or along the ray.

use exercise_spec::along_or_across::View;
use nalgebra::{Matrix2x3, Matrix3, Point3, Vector2, Vector3};

/// The drag, in world coordinates and metres, that takes a point straight away from the
/// centre of camera `seen_from`, along the ray on which that camera sees it. It is
/// `distance` long.
pub fn drag_along(
    views: Vec<View>,
    seen_from: usize,
    point_in_world: Vector3<f64>,
    distance: f64,
) -> Vector3<f64> {
    let centre = views[seen_from].camera_from_world.inverse().translation.vector;
    distance * (point_in_world - centre).normalize()
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
    let View { camera_from_world, .. } = views[seen_from];
    let ray = (camera_from_world * Point3::from(point_in_world)).coords;
    let across = Vector3::y().cross(&ray).normalize();
    distance * camera_from_world.inverse_transform_vector(&across)
}

/// How far the pixel of the point moves in each camera, to first order in the drag. The drag
/// is in world coordinates and metres, the moves are in pixels, new place minus old.
pub fn predicted_moves(
    views: Vec<View>,
    point_in_world: Vector3<f64>,
    drag: Vector3<f64>,
) -> Vec<Vector2<f64>> {
    views.iter().map(|view| pixel_by_point(view, point_in_world) * drag).collect()
}

/// How far the pixel of the point really moves in each camera. The point is in front of all
/// of them, before the drag and after it.
pub fn exact_moves(
    views: Vec<View>,
    point_in_world: Vector3<f64>,
    drag: Vector3<f64>,
) -> Vec<Vector2<f64>> {
    let pixel = |view: &View, point: Vector3<f64>| {
        view.camera.pinhole().project(&view.camera_from_world, &point).unwrap_or_default()
    };
    views
        .iter()
        .map(|view| pixel(view, point_in_world + drag) - pixel(view, point_in_world))
        .collect()
}

/// The drag of length one, in world coordinates, that all cameras **together** notice least:
/// to first order, the sum over all cameras of the squared length of the pixel's move is
/// smallest. Of the two such drags the one that leads away from camera 0.
pub fn least_noticed_drag(views: Vec<View>, point_in_world: Vector3<f64>) -> Vector3<f64> {
    let jacobians = views.iter().map(|view| pixel_by_point(view, point_in_world));
    let information: Matrix3<f64> = jacobians.map(|jacobian| jacobian.tr_mul(&jacobian)).sum();
    let eigen = information.symmetric_eigen();
    let weakest = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    let away = drag_along(views, 0, point_in_world, 1.0);
    weakest.dot(&away).signum() * weakest
}

/// The derivative of the pixel by the point in the world, in pixels per metre.
fn pixel_by_point(view: &View, point_in_world: Vector3<f64>) -> Matrix2x3<f64> {
    let in_camera = (view.camera_from_world * Point3::from(point_in_world)).coords;
    let projection = view.camera.pinhole().projection_jacobian(&in_camera).unwrap_or_default();
    projection * view.camera_from_world.rotation.to_rotation_matrix()
}
