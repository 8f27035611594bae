//! What can be done to a whole window without any measurement noticing.

use nalgebra::{Rotation3, SMatrix, UnitVector3, Vector3};
use vislam::inertial::{CameraImu, NavState};
use vislam::manifold::so3;
use vislam::observability::{Similarity, Window};

use super::oracle::{between, coasting, similar_path, state_on};
use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Windows are costly; states are not.
const WINDOWS: usize = 40;

/// Registers the equations.
pub fn exhibits(chapter: &mut Chapter) {
    let formula: Action = |window, angle, shift| {
        let rotation = about_z(angle);
        window.transformed(&Similarity { scale: 1.0, rotation, translation: *shift })
    };
    let mutants: [(_, Action); 5] = [
        ("velocity not turned", |window, angle, shift| {
            changed(window, angle, shift, |old, new| new.velocity = old.velocity)
        }),
        ("turned on the right", |window, angle, shift| {
            changed(window, angle, shift, |old, new| {
                let turn = new.world_from_body * old.world_from_body.inverse();
                new.world_from_body = old.world_from_body * turn;
            })
        }),
        ("velocity shifted", |window, angle, shift| {
            let mut moved = changed(window, angle, shift, |_, _| ());
            // Every velocity changes by the same, as the positions do.
            moved.states.iter_mut().for_each(|state| state.velocity += shift);
            moved
        }),
        ("landmarks not turned", |window, angle, shift| {
            let mut moved = changed(window, angle, shift, |_, _| ());
            moved.landmarks = window.landmarks.iter().map(|landmark| landmark + shift).collect();
            moved
        }),
        ("about a horizontal axis", |window, angle, shift| {
            let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
            window.transformed(&Similarity { scale: 1.0, rotation, translation: *shift })
        }),
    ];
    chapter.equation("four-invariance", four_invariance, formula, &mutants);

    let mutants: [(_, Four); 4] = [
        ("yaw about the body's own axis", |state, landmark| {
            let mut columns = four(state, landmark);
            columns.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::z());
            columns
        }),
        ("velocity not turned", |state, landmark| {
            let mut columns = four(state, landmark);
            columns.fixed_view_mut::<3, 1>(3, 3).fill(0.0);
            columns
        }),
        ("sign of the turn of the position", |state, landmark| {
            let mut columns = four(state, landmark);
            columns.fixed_view_mut::<3, 1>(6, 3).neg_mut();
            columns
        }),
        ("shift in the body frame", |state, landmark| {
            let mut columns = four(state, landmark);
            let block = state.world_from_body.matrix().transpose();
            columns.fixed_view_mut::<3, 3>(6, 0).copy_from(&block);
            columns
        }),
    ];
    chapter.equation("four-null-vectors", four_null_vectors, four, &mutants);

    let formula: Moved = |similarity, rig, state, rate| {
        similarity.state(state, &rig.body_from_camera.translation.vector, rate)
    };
    let mutants: [(_, Moved); 5] = [
        ("lever grows too", |similarity, _, state, rate| {
            similarity.state(state, &Vector3::zeros(), rate)
        }),
        ("swing dropped", |similarity, rig, state, _| {
            similarity.state(state, &rig.body_from_camera.translation.vector, &Vector3::zeros())
        }),
        ("sign of the lever", |similarity, rig, state, rate| {
            similarity.state(state, &-rig.body_from_camera.translation.vector, rate)
        }),
        ("rotation transposed", |similarity, rig, state, rate| {
            let similarity = Similarity { rotation: similarity.rotation.inverse(), ..*similarity };
            similarity.state(state, &rig.body_from_camera.translation.vector, rate)
        }),
        ("velocity does not grow", |similarity, rig, state, rate| {
            let lever = rig.body_from_camera.translation.vector;
            let velocity = similarity.rotation * state.velocity;
            NavState { velocity, ..similarity.state(state, &lever, rate) }
        }),
    ];
    chapter.equation("moved-state", moved_state, formula, &mutants);

    let mutants: [(_, Seven); 5] = [
        ("body for camera in the growth", |_, state, rate, landmark| {
            seven(&Vector3::zeros(), state, rate, landmark)
        }),
        ("swing dropped", |lever, state, _, landmark| {
            seven(lever, state, &Vector3::zeros(), landmark)
        }),
        ("turn in the world's axes", |lever, state, rate, landmark| {
            let mut columns = seven(lever, state, rate, landmark);
            columns.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
            columns
        }),
        ("sign of a cross product", |lever, state, rate, landmark| {
            let mut columns = seven(lever, state, rate, landmark);
            columns.fixed_view_mut::<3, 3>(6, 3).neg_mut();
            columns
        }),
        ("velocity does not grow", |lever, state, rate, landmark| {
            let mut columns = seven(lever, state, rate, landmark);
            columns.fixed_view_mut::<3, 1>(3, 6).fill(0.0);
            columns
        }),
    ];
    chapter.equation("seven-null-vectors", seven_null_vectors, seven, &mutants);

    let axes = [Vector3::z_axis(), Vector3::x_axis()];
    chapter.counterexample("vi-four", "about-gravity", turned_about, axes);
}

/// All residuals of a window before and after it is turned about an axis.
fn turned_about(axis: UnitVector3<f64>) -> Comparison {
    let mut comparison = Comparison::relative("the residuals before", 1e-10);
    let window = draws::wrong_window(&mut Random::new(8));
    let rotation = Rotation3::from_axis_angle(&axis, 0.3);
    let turned = window.transformed(&Similarity { rotation, ..Similarity::identity() });
    let residual = |window: &Window| window.residual().map(|rows| rows.as_slice().to_vec());
    if let (Ok(before), Ok(after)) = (residual(&window), residual(&turned)) {
        comparison.add(&after, &before);
    }
    comparison
}

fn about_z(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

/// The right action, and something wrong with every state, which is shown before and after.
fn changed(
    window: &Window,
    angle: f64,
    shift: &Vector3<f64>,
    change: fn(&NavState, &mut NavState),
) -> Window {
    let rotation = about_z(angle);
    let mut moved = window.transformed(&Similarity { scale: 1.0, rotation, translation: *shift });
    for (old, new) in window.states.iter().zip(&mut moved.states) {
        change(old, new);
    }
    moved
}

/// Takes a window, the angle in radians and the shift in metres.
type Action = fn(&Window, f64, &Vector3<f64>) -> Window;

fn four_invariance(formula: Action) -> Comparison {
    let against = "the residuals before, at estimates off by decimetres";
    let mut comparison = Comparison::relative(against, 1e-10);
    let mut random = Random::new(4);
    for _ in 0..WINDOWS {
        let window = draws::wrong_window(&mut random);
        let shift = random.uniform(0.1..9.0);
        let (angle, shift) = (random.uniform(0.2..3.0), random.direction(shift));
        let residual = |window: &Window| {
            let rows = window.residual().map(|rows| rows.as_slice().to_vec());
            // A landmark behind the camera has no residual; the comparison refuses it.
            rows.unwrap_or_else(|_| vec![f64::INFINITY])
        };
        let before = residual(&window);
        let mut after = residual(&formula(&window, angle, &shift));
        after.resize(before.len(), f64::INFINITY);
        let after: Vec<f64> = after.iter().map(|row| row.clamp(-1e9, 1e9)).collect();
        comparison.add(&after, &before);
    }
    comparison
}

/// The four columns of a state, and of a landmark below it.
fn four(state: &NavState, landmark: &Vector3<f64>) -> SMatrix<f64, 12, 4> {
    let mut columns = SMatrix::<f64, 12, 4>::zeros();
    columns.fixed_view_mut::<3, 3>(6, 0).fill_with_identity();
    columns.fixed_view_mut::<3, 3>(9, 0).fill_with_identity();
    let up = Vector3::z();
    let yaw = [
        state.world_from_body.inverse() * up,
        up.cross(&state.velocity),
        up.cross(&state.position),
        up.cross(landmark),
    ];
    for (row, block) in yaw.iter().enumerate() {
        columns.fixed_view_mut::<3, 1>(3 * row, 3).copy_from(block);
    }
    columns
}

type Four = fn(&NavState, &Vector3<f64>) -> SMatrix<f64, 12, 4>;

fn four_null_vectors(formula: Four) -> Comparison {
    let against = "central differences of a shift and a turn of everything";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(5);
    for _ in 0..STATES {
        let state = draws::state(&mut random);
        let landmark = random.direction(8.0);
        let step = 1e-5;
        let moved = |way: usize, step: f64| {
            let turn = about_z(if way == 3 { step } else { 0.0 });
            let shift = if way < 3 { step * Vector3::ith(way, 1.0) } else { Vector3::zeros() };
            let state = NavState {
                world_from_body: turn * state.world_from_body,
                velocity: turn * state.velocity,
                position: turn * state.position + shift,
            };
            (state, turn * landmark + shift)
        };
        let mut oracle = SMatrix::<f64, 12, 4>::zeros();
        for way in 0..4 {
            let (before, after) = (moved(way, -step), moved(way, step));
            let [phi, v, p] = between(&before.0, &after.0);
            for (row, block) in [phi, v, p, after.1 - before.1].iter().enumerate() {
                let slope = block / (2.0 * step);
                oracle.fixed_view_mut::<3, 1>(3 * row, way).copy_from(&slope);
            }
        }
        comparison.add(formula(&state, &landmark).as_slice(), oracle.as_slice());
    }
    comparison
}

type Moved = fn(&Similarity, &CameraImu, &NavState, &Vector3<f64>) -> NavState;

fn moved_state(formula: Moved) -> Comparison {
    let against = "the body hung again on a camera whose path has been moved, turned and grown";
    let mut comparison = Comparison::absolute(against, 1e-6, "rad, m/s and m");
    let mut random = Random::new(6);
    for _ in 0..STATES {
        let (state, rig) = (draws::state(&mut random), draws::rig(&mut random));
        let (rate, similarity) = (random.direction(1.5), draws::similarity(&mut random));
        let path = coasting(&state, &rate);
        let oracle = state_on(&|t| similar_path(&path, &rig, &similarity, t), 0.0);
        let moved = formula(&similarity, &rig, &state, &rate);
        let error = between(&oracle, &moved);
        comparison.add(error.map(<[f64; 3]>::from).as_flattened(), &[0.0; 9]);
    }
    comparison
}

/// The seven columns of a state with its camera on a lever arm, and of a landmark below it.
fn seven(
    lever: &Vector3<f64>,
    state: &NavState,
    rate: &Vector3<f64>,
    landmark: &Vector3<f64>,
) -> SMatrix<f64, 12, 7> {
    let mut columns = SMatrix::<f64, 12, 7>::zeros();
    columns.fixed_view_mut::<3, 3>(6, 0).fill_with_identity();
    columns.fixed_view_mut::<3, 3>(9, 0).fill_with_identity();
    let mut put = |row: usize, column: usize, block: nalgebra::Matrix3<f64>| {
        columns.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    };
    put(0, 3, state.world_from_body.matrix().transpose());
    put(3, 3, -so3::hat(&state.velocity));
    put(6, 3, -so3::hat(&state.position));
    put(9, 3, -so3::hat(landmark));
    let rotation = state.world_from_body;
    let growth = [
        state.velocity + rotation * rate.cross(lever),
        state.position + rotation * lever,
        *landmark,
    ];
    for (row, block) in growth.iter().enumerate() {
        columns.fixed_view_mut::<3, 1>(3 + 3 * row, 6).copy_from(block);
    }
    columns
}

type Seven = fn(&Vector3<f64>, &NavState, &Vector3<f64>, &Vector3<f64>) -> SMatrix<f64, 12, 7>;

fn seven_null_vectors(formula: Seven) -> Comparison {
    let against = "central differences of a camera's path that is moved, turned and grown";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(7);
    for _ in 0..STATES {
        let (state, rig) = (draws::state(&mut random), draws::rig(&mut random));
        let (rate, landmark) = (random.direction(1.5), random.direction(8.0));
        let path = coasting(&state, &rate);
        let step = 1e-3;
        let moved = |way: usize, step: f64| {
            let along = |first: usize| {
                if (first..first + 3).contains(&way) {
                    Vector3::ith(way - first, step)
                } else {
                    Vector3::zeros()
                }
            };
            let similarity = Similarity {
                scale: 1.0 + if way == 6 { step } else { 0.0 },
                rotation: so3::exp(&along(3)),
                translation: along(0),
            };
            let state = state_on(&|t| similar_path(&path, &rig, &similarity, t), 0.0);
            let landmark = similarity.scale * (similarity.rotation * landmark);
            (state, landmark + similarity.translation)
        };
        let mut oracle = SMatrix::<f64, 12, 7>::zeros();
        for way in 0..7 {
            let (before, after) = (moved(way, -step), moved(way, step));
            let [phi, v, p] = between(&before.0, &after.0);
            for (row, block) in [phi, v, p, after.1 - before.1].iter().enumerate() {
                let slope = block / (2.0 * step);
                oracle.fixed_view_mut::<3, 1>(3 * row, way).copy_from(&slope);
            }
        }
        let lever = rig.body_from_camera.translation.vector;
        comparison.add(formula(&lever, &state, &rate, &landmark).as_slice(), oracle.as_slice());
    }
    comparison
}
