//! Ways to the chapter's results that do not use its formulas.

use nalgebra::{Matrix4, Rotation3, Vector2, Vector3};
use vislam::inertial::{CameraImu, NavState};
use vislam::manifold::so3;
use vislam::observability::Similarity;
use vislam::reprojection::Pinhole;
use vislam::simulation::Trajectory;

/// A landmark in camera coordinates, by matrices of homogeneous coordinates.
pub fn in_camera(rig: &CameraImu, state: &NavState, landmark: &Vector3<f64>) -> Vector3<f64> {
    let mut world_from_body = Matrix4::identity();
    world_from_body.fixed_view_mut::<3, 3>(0, 0).copy_from(state.world_from_body.matrix());
    world_from_body.fixed_view_mut::<3, 1>(0, 3).copy_from(&state.position);
    let world_from_camera = world_from_body * rig.body_from_camera.to_homogeneous();
    let camera_from_world = world_from_camera.try_inverse().unwrap_or(Matrix4::zeros());
    (camera_from_world * landmark.push(1.0)).xyz()
}

/// Where a camera on a body sees a landmark; NaN behind it.
pub fn seen(
    camera: &Pinhole,
    rig: &CameraImu,
    state: &NavState,
    landmark: &Vector3<f64>,
) -> Vector2<f64> {
    let point = in_camera(rig, state, landmark);
    let pixel = Vector2::new(
        camera.fx * point.x / point.z + camera.cx,
        camera.fy * point.y / point.z + camera.cy,
    );
    if point.z > 0.0 { pixel } else { Vector2::repeat(f64::NAN) }
}

/// A path of the body: at a time, its rotation and its position.
pub type Path<'a> = &'a dyn Fn(f64) -> (Rotation3<f64>, Vector3<f64>);

/// The path of a body whose camera goes along a similar path: the camera's centre is moved, the
/// camera turned, and the body hung on it again.
pub fn similar_path(
    path: Path,
    rig: &CameraImu,
    similarity: &Similarity,
    t: f64,
) -> (Rotation3<f64>, Vector3<f64>) {
    let (rotation, position) = path(t);
    let body_from_camera = rig.body_from_camera.rotation.to_rotation_matrix();
    let centre = position + rotation * rig.body_from_camera.translation.vector;
    let centre = similarity.scale * (similarity.rotation * centre) + similarity.translation;
    let world_from_camera = similarity.rotation * rotation * body_from_camera;
    let camera_from_body = rig.body_from_camera.inverse();
    let body = centre + world_from_camera * camera_from_body.translation.vector;
    (world_from_camera * body_from_camera.inverse(), body)
}

/// The path of a body that keeps its velocity and angular velocity.
pub fn coasting(
    state: &NavState,
    angular_velocity: &Vector3<f64>,
) -> impl Fn(f64) -> (Rotation3<f64>, Vector3<f64>) {
    let (state, rate) = (*state, *angular_velocity);
    move |t| (state.world_from_body * so3::exp(&(t * rate)), state.position + t * state.velocity)
}

/// The path of a motion.
pub fn path_of(motion: &Trajectory) -> impl Fn(f64) -> (Rotation3<f64>, Vector3<f64>) {
    let motion = *motion;
    move |t| {
        let state = motion.at(t).state;
        (state.world_from_body, state.position)
    }
}

/// The state on a path, its velocity by central differences.
pub fn state_on(path: Path, t: f64) -> NavState {
    let (world_from_body, position) = path(t);
    let step = 1e-4;
    let velocity = (path(t + step).1 - path(t - step).1) / (2.0 * step);
    NavState { world_from_body, velocity, position }
}

/// The specific force on a path, its acceleration by central differences.
pub fn force_on(path: Path, gravity: &Vector3<f64>, t: f64) -> Vector3<f64> {
    let (rotation, position) = path(t);
    let step = 1e-3;
    let acceleration = (path(t + step).1 - 2.0 * position + path(t - step).1) / (step * step);
    rotation.inverse() * (acceleration - gravity)
}

/// The step (φ, v, p) from one state to another.
pub fn between(from: &NavState, to: &NavState) -> [Vector3<f64>; 3] {
    [
        so3::local(&from.world_from_body, &to.world_from_body),
        to.velocity - from.velocity,
        to.position - from.position,
    ]
}
