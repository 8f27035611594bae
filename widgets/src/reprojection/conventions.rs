//! One problem for two optimizers, and what leads from the Jacobian of one to that of the other.

use nalgebra::{Isometry3, Matrix6, Rotation3, Vector3};
use vislam::manifold::se3;
use vislam::simulation::Scene;

/// Cameras of the street, how far they see along it in metres, and of what the scene is drawn.
const STREET: (usize, f64, u64) = (4, 2.5, 1);

/// From the derivative by a step on the right of a pose to that by a step in its midst: with a side of one half
/// the first half of the motion comes before the step and the second half after it; zero is the right, one the left.
pub fn to_side(pose: &Isometry3<f64>, side: f64) -> Matrix6<f64> {
    se3::adjoint(&se3::exp(&(-side * se3::log(pose))))
}

/// A street in a world frame from which its cameras are turned by `angle` radians, with a start so many times as far
/// off as the street has it. The first and the last camera are where they belong.
pub fn street(angle: f64, noise: f64, start: f64) -> Scene {
    let (cameras, reach, seed) = STREET;
    let mut scene = Scene::street(cameras, reach, noise, seed).with_start(start);
    let first = scene.true_cameras[0].camera_from_world;
    let middle = Vector3::x() * (cameras - 1) as f64 / 2.0;
    let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), -angle) * first.rotation;
    let turned = Isometry3::from_parts((-(turn * middle)).into(), turn);
    let is_held = |camera: usize| camera == 0 || camera == cameras - 1;
    scene.problem.fixed = (0..cameras).map(is_held).collect();
    for (number, truth) in scene.true_cameras.iter_mut().enumerate() {
        let camera = &mut scene.problem.cameras[number];
        truth.camera_from_world *= turned.inverse();
        camera.camera_from_world *= turned.inverse();
        if is_held(number) {
            *camera = *truth;
        }
    }
    for point in scene.true_points.iter_mut().chain(&mut scene.problem.points) {
        *point = se3::transform(&turned, point);
    }
    scene
}
