//! What can be done to a whole window without any measurement noticing.

use nalgebra::{Rotation3, SMatrix, SVector, UnitVector3, Vector3};
use vislam::inertial::NavState;
use vislam::manifold::so3;
use vislam::observability::{Similarity, Window};

use super::oracle::{between, coasting, similar_path, state_on};
use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered};
use crate::random::Random;

/// Windows are costly; states are not.
const WINDOWS: usize = 40;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Action = |window, angle, shift| turned(window, Vector3::z_axis(), angle, shift);
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
            altered(changed(window, angle, shift, |_, _| ()), |moved| {
                // Every velocity changes by the same, as the positions do.
                moved.states.iter_mut().for_each(|state| state.velocity += shift);
            })
        }),
        ("landmarks not turned", |window, angle, shift| {
            altered(changed(window, angle, shift, |_, _| ()), |moved| {
                moved.landmarks = window.landmarks.iter().map(|point| point + shift).collect();
            })
        }),
        ("about a horizontal axis", |window, angle, shift| {
            turned(window, Vector3::x_axis(), angle, shift)
        }),
    ];
    chapter.equation("four-invariance", four_invariance, formula, &mutants);

    let mutants: [(_, Four); 4] = [
        ("yaw about the body's own axis", |state, landmark| {
            altered(four(state, landmark), |columns| {
                columns.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::z())
            })
        }),
        ("velocity not turned", |state, landmark| {
            altered(four(state, landmark), |columns| columns.fixed_view_mut::<3, 1>(3, 3).fill(0.0))
        }),
        ("sign of the turn of the position", |state, landmark| {
            altered(four(state, landmark), |columns| columns.fixed_view_mut::<3, 1>(6, 3).neg_mut())
        }),
        ("shift in the body frame", |state, landmark| {
            let block = state.world_from_body.matrix().transpose();
            altered(four(state, landmark), |columns| {
                columns.fixed_view_mut::<3, 3>(6, 0).copy_from(&block)
            })
        }),
    ];
    chapter.equation("four-null-vectors", four_null_vectors, four, &mutants);

    let mutants: [(_, Moved); 5] = [
        ("lever grows too", |s, state, _, rate| s.state(state, &Vector3::zeros(), rate)),
        ("swing dropped", |s, state, lever, _| s.state(state, lever, &Vector3::zeros())),
        ("sign of the lever", |s, state, lever, rate| s.state(state, &-lever, rate)),
        ("rotation transposed", |s, state, lever, rate| {
            Similarity { rotation: s.rotation.inverse(), ..*s }.state(state, lever, rate)
        }),
        ("velocity does not grow", |s, state, lever, rate| NavState {
            velocity: s.rotation * state.velocity,
            ..s.state(state, lever, rate)
        }),
    ];
    chapter.equation("moved-state", moved_state, Similarity::state, &mutants);

    let mutants: [(_, Seven); 5] = [
        ("body for camera in the growth", |_, state, rate, landmark| {
            seven(&Vector3::zeros(), state, rate, landmark)
        }),
        ("swing dropped", |lever, state, _, landmark| {
            seven(lever, state, &Vector3::zeros(), landmark)
        }),
        ("turn in the world's axes", |lever, state, rate, landmark| {
            altered(seven(lever, state, rate, landmark), |columns| {
                columns.fixed_view_mut::<3, 3>(0, 3).fill_with_identity()
            })
        }),
        ("sign of a cross product", |lever, state, rate, landmark| {
            altered(seven(lever, state, rate, landmark), |columns| {
                columns.fixed_view_mut::<3, 3>(6, 3).neg_mut()
            })
        }),
        ("velocity does not grow", |lever, state, rate, landmark| {
            altered(seven(lever, state, rate, landmark), |columns| {
                columns.fixed_view_mut::<3, 1>(3, 6).fill(0.0)
            })
        }),
    ];
    chapter.equation("seven-null-vectors", seven_null_vectors, seven, &mutants);

    let axes = [Vector3::z_axis(), Vector3::x_axis()];
    chapter.counterexample("vi-four", "about-gravity", turned_about, axes);
}

/// All residuals of a window before and after it is turned about an axis.
fn turned_about(axis: UnitVector3<f64>) -> Comparison {
    let window = draws::wrong_window(&mut Random::new(8));
    let turned = turned(&window, axis, 0.3, &Vector3::zeros());
    let residual = |window: &Window| window.residual().expect("landmarks stay in front");
    Comparison::relative("the residuals before", 1e-10).once(residual(&turned), residual(&window))
}

fn turned(window: &Window, axis: UnitVector3<f64>, angle: f64, shift: &Vector3<f64>) -> Window {
    let rotation = Rotation3::from_axis_angle(&axis, angle);
    window.transformed(&Similarity { scale: 1.0, rotation, translation: *shift })
}

/// The right action, and something wrong with every state, which is shown before and after.
fn changed(
    window: &Window,
    angle: f64,
    shift: &Vector3<f64>,
    change: fn(&NavState, &mut NavState),
) -> Window {
    let mut moved = turned(window, Vector3::z_axis(), angle, shift);
    let states = window.states.iter().zip(&mut moved.states);
    states.for_each(|(old, new)| change(old, new));
    moved
}

/// Takes a window, the angle in radians and the shift in metres.
type Action = fn(&Window, f64, &Vector3<f64>) -> Window;

fn four_invariance(formula: Action) -> Comparison {
    let against = "the residuals before, at estimates off by decimetres";
    Comparison::relative(against, 1e-10).over(WINDOWS, 4, |random| {
        let window = draws::wrong_window(random);
        let shift = random.uniform(0.1..9.0);
        let (angle, shift) = (random.uniform(0.2..3.0), random.direction(shift));
        let before = window.residual().expect("landmarks are in front");
        // A landmark behind the camera has no residual, which is as far off as can be said.
        let after = formula(&window, angle, &shift).residual();
        let after = after.map_or(before.map(|_| 1e9), |rows| rows.map(|row| row.clamp(-1e9, 1e9)));
        (after, before)
    })
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
    Comparison::relative(against, 1e-8).over(STATES, 5, |random| {
        let state = draws::state(random);
        let landmark = random.direction(8.0);
        let oracle = columns(1e-5, |[x, y, z, yaw]| {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
            let shift = Vector3::new(x, y, z);
            let state = NavState {
                world_from_body: turn * state.world_from_body,
                velocity: turn * state.velocity,
                position: turn * state.position + shift,
            };
            (state, turn * landmark + shift)
        });
        (formula(&state, &landmark), oracle)
    })
}

/// How a state, and a landmark below it, answer to each of several numbers, by central differences.
fn columns<const N: usize>(
    step: f64,
    moved: impl Fn([f64; N]) -> (NavState, Vector3<f64>),
) -> SMatrix<f64, 12, N> {
    let column = |way| {
        let [before, after] =
            [-step, step].map(|step| moved(altered([0.0; N], |numbers| numbers[way] = step)));
        let [phi, v, p] = between(&before.0, &after.0);
        let blocks = [phi, v, p, after.1 - before.1].map(<[f64; 3]>::from);
        SVector::<f64, 12>::from_column_slice(blocks.as_flattened()) / (2.0 * step)
    };
    SMatrix::from_columns(&std::array::from_fn::<_, N, _>(column))
}

/// Takes a similarity, a state, the lever arm of its camera and its angular velocity.
type Moved = fn(&Similarity, &NavState, &Vector3<f64>, &Vector3<f64>) -> NavState;

fn moved_state(formula: Moved) -> Comparison {
    let against = "the body hung again on a camera whose path has been moved, turned and grown";
    Comparison::absolute(against, 1e-6, "rad, m/s and m").over(STATES, 6, |random| {
        let (state, rig) = (draws::state(random), draws::rig(random));
        let (rate, similarity) = (random.direction(1.5), draws::similarity(random));
        let path = coasting(&state, &rate);
        let oracle = state_on(&|t| similar_path(&path, &rig, &similarity, t), 0.0);
        let moved = formula(&similarity, &state, &rig.body_from_camera.translation.vector, &rate);
        (between(&oracle, &moved), [Vector3::zeros(); 3])
    })
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
    Comparison::relative(against, 1e-6).over(STATES, 7, |random| {
        let (state, rig) = (draws::state(random), draws::rig(random));
        let (rate, landmark) = (random.direction(1.5), random.direction(8.0));
        let path = coasting(&state, &rate);
        let oracle = columns(1e-3, |[x, y, z, roll, pitch, yaw, growth]| {
            let similarity = Similarity {
                scale: 1.0 + growth,
                rotation: so3::exp(&Vector3::new(roll, pitch, yaw)),
                translation: Vector3::new(x, y, z),
            };
            let state = state_on(&|t| similar_path(&path, &rig, &similarity, t), 0.0);
            let landmark = similarity.scale * (similarity.rotation * landmark);
            (state, landmark + similarity.translation)
        });
        let lever = rig.body_from_camera.translation.vector;
        (formula(&lever, &state, &rate, &landmark), oracle)
    })
}
