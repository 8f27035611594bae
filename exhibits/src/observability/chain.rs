//! From the state of a body to the pixel of a landmark.

use nalgebra::{Matrix2x3, Matrix3, SMatrix, Vector3};
use vislam::factors as theory;
use vislam::inertial::{CameraImu, NavState};
use vislam::least_squares::Manifold;
use vislam::manifold::{se3, so3};

use super::STATES;
use super::draws;
use super::oracle::{in_camera, seen};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Registers the equations.
pub fn exhibits(chapter: &mut Chapter) {
    let formula: Landmark = |rig, state, landmark| {
        let in_body = state.world_from_body.inverse() * (landmark - state.position);
        rig.body_from_camera.rotation.inverse()
            * (in_body - rig.body_from_camera.translation.vector)
    };
    let mutants: [(_, Landmark); 4] = [
        ("lever dropped", |rig, state, landmark| {
            let in_body = state.world_from_body.inverse() * (landmark - state.position);
            rig.body_from_camera.rotation.inverse() * in_body
        }),
        ("lever added", |rig, state, landmark| {
            let in_body = state.world_from_body.inverse() * (landmark - state.position);
            rig.body_from_camera.rotation.inverse()
                * (in_body + rig.body_from_camera.translation.vector)
        }),
        ("lever in the camera's axes", |rig, state, landmark| {
            let in_body = state.world_from_body.inverse() * (landmark - state.position);
            rig.body_from_camera.rotation.inverse() * in_body
                - rig.body_from_camera.translation.vector
        }),
        ("rotation transposed", |rig, state, landmark| {
            let in_body = state.world_from_body * (landmark - state.position);
            rig.body_from_camera.rotation.inverse()
                * (in_body - rig.body_from_camera.translation.vector)
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
            let mut twist = theory::twist_by_state(state);
            let block = -state.world_from_body.matrix().transpose();
            twist.fixed_view_mut::<3, 3>(0, 6).copy_from(&block);
            twist
        }),
        ("rotation dropped", |_, state| {
            let mut twist = theory::twist_by_state(state);
            twist.fixed_view_mut::<3, 3>(3, 0).copy_from(&-Matrix3::identity());
            twist
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
            let mut block = theory::pixel_by_state(state, landmark, by_point);
            block.columns_mut(0, 3).neg_mut();
            block
        }),
        ("turn in the world", |_, state, landmark, by_point| {
            let mut block = theory::pixel_by_state(state, landmark, by_point);
            let arm = by_point * so3::hat(&(landmark - state.position));
            block.fixed_view_mut::<2, 3>(0, 0).copy_from(&arm);
            block
        }),
        ("sign of the position", |_, state, landmark, by_point| {
            let mut block = theory::pixel_by_state(state, landmark, by_point);
            block.columns_mut(6, 3).neg_mut();
            block
        }),
    ];
    chapter.equation("pixel-by-state", pixel_by_state, formula, &mutants);
}

type Landmark = fn(&CameraImu, &NavState, &Vector3<f64>) -> Vector3<f64>;

fn landmark_from_state(formula: Landmark) -> Comparison {
    let against = "the inverse of a product of homogeneous matrices";
    let mut comparison = Comparison::absolute(against, 1e-11, "m");
    let mut random = Random::new(1);
    for _ in 0..STATES {
        let (rig, state) = (draws::rig(&mut random), draws::state(&mut random));
        let landmark = random.direction(9.0);
        let oracle = in_camera(&rig, &state, &landmark);
        comparison.add(formula(&rig, &state, &landmark).as_slice(), oracle.as_slice());
    }
    comparison
}

type Twist = fn(&CameraImu, &NavState) -> SMatrix<f64, 6, 9>;

fn twist_by_state(formula: Twist) -> Comparison {
    let against = "central differences of the camera's pose";
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(2);
    for _ in 0..STATES {
        let (rig, state) = (draws::rig(&mut random), draws::state(&mut random));
        let pose = rig.camera_from_world(&state);
        let mut oracle = SMatrix::<f64, 6, 9>::zeros();
        for column in 0..9 {
            let moved = |step: f64| {
                let mut by = [0.0; 9];
                by[column] = step;
                se3::local(&pose, &rig.camera_from_world(&state.retract(&by)))
            };
            oracle.set_column(column, &((moved(1e-5) - moved(-1e-5)) / 2e-5));
        }
        comparison.add(formula(&rig, &state).as_slice(), oracle.as_slice());
    }
    comparison
}

type PixelBlock = fn(&CameraImu, &NavState, &Vector3<f64>, &Matrix2x3<f64>) -> SMatrix<f64, 2, 9>;

fn pixel_by_state(formula: PixelBlock) -> Comparison {
    let against = "central differences of the pixel";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(3);
    for _ in 0..STATES {
        let (rig, state) = (draws::rig(&mut random), draws::state(&mut random));
        let camera = random.camera();
        let ahead = random.point(2.0..20.0);
        let landmark = rig.world_from_camera(&state) * nalgebra::Point3::from(ahead);
        let landmark = landmark.coords;
        let by_point = (0..3).map(|axis| {
            let pixel = |step: f64| {
                seen(&camera, &rig, &state, &(landmark + step * Vector3::ith(axis, 1.0)))
            };
            (pixel(1e-5) - pixel(-1e-5)) / 2e-5
        });
        let by_point = Matrix2x3::from_columns(&by_point.collect::<Vec<_>>());
        let mut oracle = SMatrix::<f64, 2, 9>::zeros();
        for column in 0..9 {
            let pixel = |step: f64| {
                let mut by = [0.0; 9];
                by[column] = step;
                seen(&camera, &rig, &state.retract(&by), &landmark)
            };
            oracle.set_column(column, &((pixel(1e-5) - pixel(-1e-5)) / 2e-5));
        }
        let block = formula(&rig, &state, &landmark, &by_point);
        comparison.add(block.as_slice(), oracle.as_slice());
    }
    comparison
}
