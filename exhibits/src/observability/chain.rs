//! From the state of a body to the pixel of a landmark.

use nalgebra::{Matrix2x3, Matrix3, Point3, SMatrix, SVector, Vector3};
use vislam::factors as theory;
use vislam::inertial::{CameraImu, NavState};
use vislam::least_squares::Manifold;
use vislam::manifold::{se3, so3};

use super::STATES;
use super::draws;
use super::oracle::{in_camera, seen};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Landmark =
        |rig, state, landmark| turned(rig, &(in_body(state, landmark) - lever(rig)));
    let mutants: [(_, Landmark); 4] = [
        ("lever dropped", |rig, state, landmark| turned(rig, &in_body(state, landmark))),
        ("lever added", |rig, state, landmark| {
            turned(rig, &(in_body(state, landmark) + lever(rig)))
        }),
        ("lever in the camera's axes", |rig, state, landmark| {
            turned(rig, &in_body(state, landmark)) - lever(rig)
        }),
        ("rotation transposed", |rig, state, landmark| {
            turned(rig, &(state.world_from_body * (landmark - state.position) - lever(rig)))
        }),
    ];
    chapter.equation("landmark-from-state", landmark_from_state, formula, &mutants);

    let formula: Twist = |_, state| theory::twist_by_state(state);
    let mutants: [(_, Twist); 5] = [
        ("about the camera's centre", |rig, state| {
            let centre = rig.world_from_camera(state).translation.vector;
            theory::twist_by_state(&NavState { position: centre, ..*state })
        }),
        ("sign of the cross product", |_, state| {
            theory::twist_by_state(&NavState { position: -state.position, ..*state })
        }),
        ("rotation transposed", |_, state| {
            let world_from_body = state.world_from_body.inverse();
            theory::twist_by_state(&NavState { world_from_body, ..*state })
        }),
        ("position in the body frame", |_, state| {
            let block = -state.world_from_body.matrix().transpose();
            altered(theory::twist_by_state(state), |twist| {
                twist.fixed_view_mut::<3, 3>(0, 6).copy_from(&block);
            })
        }),
        ("rotation dropped", |_, state| {
            altered(theory::twist_by_state(state), |twist| {
                twist.fixed_view_mut::<3, 3>(3, 0).copy_from(&-Matrix3::identity());
            })
        }),
    ];
    chapter.equation("twist-by-state", twist_by_state, formula, &mutants);

    let formula: PixelBlock =
        |_, state, landmark, by_point| theory::pixel_by_state(state, landmark, by_point);
    let mutants: [(_, PixelBlock); 4] = [
        ("arm from the camera's centre", |rig, state, landmark, by_point| {
            let position = rig.world_from_camera(state).translation.vector;
            theory::pixel_by_state(&NavState { position, ..*state }, landmark, by_point)
        }),
        ("sign of the arm", |_, state, landmark, by_point| {
            let block = theory::pixel_by_state(state, landmark, by_point);
            altered(block, |block| block.columns_mut(0, 3).neg_mut())
        }),
        ("turn in the world", |_, state, landmark, by_point| {
            let arm = by_point * so3::hat(&(landmark - state.position));
            let block = theory::pixel_by_state(state, landmark, by_point);
            altered(block, |block| block.fixed_view_mut::<2, 3>(0, 0).copy_from(&arm))
        }),
        ("sign of the position", |_, state, landmark, by_point| {
            let block = theory::pixel_by_state(state, landmark, by_point);
            altered(block, |block| block.columns_mut(6, 3).neg_mut())
        }),
    ];
    chapter.equation("pixel-by-state", pixel_by_state, formula, &mutants);
}

/// From the axes of the body to those of the camera.
fn turned(rig: &CameraImu, in_body: &Vector3<f64>) -> Vector3<f64> {
    rig.body_from_camera.rotation.inverse() * in_body
}

fn lever(rig: &CameraImu) -> Vector3<f64> {
    rig.body_from_camera.translation.vector
}

/// A landmark in the axes of the body.
fn in_body(state: &NavState, landmark: &Vector3<f64>) -> Vector3<f64> {
    state.world_from_body.inverse() * (landmark - state.position)
}

type Landmark = fn(&CameraImu, &NavState, &Vector3<f64>) -> Vector3<f64>;

fn landmark_from_state(formula: Landmark) -> Comparison {
    let against = "the inverse of a product of homogeneous matrices";
    Comparison::absolute(against, 1e-11, "m").over(STATES, 1, |random| {
        let (rig, state) = (draws::rig(random), draws::state(random));
        let landmark = random.direction(9.0);
        (formula(&rig, &state, &landmark), in_camera(&rig, &state, &landmark))
    })
}

type Twist = fn(&CameraImu, &NavState) -> SMatrix<f64, 6, 9>;

fn twist_by_state(formula: Twist) -> Comparison {
    let against = "central differences of the camera's pose";
    Comparison::relative(against, 1e-7).over(STATES, 2, |random| {
        let (rig, state) = (draws::rig(random), draws::state(random));
        let pose = rig.camera_from_world(&state);
        let oracle = differences(1e-5, |step: SVector<f64, 9>| {
            se3::local(&pose, &rig.camera_from_world(&state.retract(step.as_slice())))
        });
        (formula(&rig, &state), oracle)
    })
}

type PixelBlock = fn(&CameraImu, &NavState, &Vector3<f64>, &Matrix2x3<f64>) -> SMatrix<f64, 2, 9>;

fn pixel_by_state(formula: PixelBlock) -> Comparison {
    let against = "central differences of the pixel";
    Comparison::relative(against, 1e-6).over(STATES, 3, |random| {
        let (rig, state) = (draws::rig(random), draws::state(random));
        let camera = random.camera();
        let landmark = rig.world_from_camera(&state) * Point3::from(random.point(2.0..20.0));
        let landmark = landmark.coords;
        let by_point = differences(1e-5, |step| seen(&camera, &rig, &state, &(landmark + step)));
        let oracle = differences(1e-5, |step: SVector<f64, 9>| {
            seen(&camera, &rig, &state.retract(step.as_slice()), &landmark)
        });
        (formula(&rig, &state, &landmark, &by_point), oracle)
    })
}
