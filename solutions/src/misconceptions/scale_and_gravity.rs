//! Wrong answers to [`scale_and_gravity`](crate::scale_and_gravity).

use exercise_spec::scale_and_gravity::*;
use nalgebra::{Rotation3, Vector3};
use vislam::manifold::so3;

use super::Wrong;
use crate::scale_and_gravity as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    scaled_window: right::scaled_window,
    split_residual: right::split_residual,
    scale_is_free: right::scale_is_free,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let window = |misconception, scaled_window| {
        Wrong::new(misconception, Functions { scaled_window, ..REFERENCE })
    };
    let parts = |misconception, split_residual| {
        Wrong::new(misconception, Functions { split_residual, ..REFERENCE })
    };
    let verdict = |misconception, scale_is_free| {
        Wrong::new(misconception, Functions { scale_is_free, ..REFERENCE })
    };
    vec![
        window(&SCALED_ABOUT_ORIGIN, |window, scale| {
            let state = |state: &State| State {
                velocity: scale * state.velocity,
                position: scale * state.position,
                ..*state
            };
            Window {
                states: window.states.iter().map(state).collect(),
                landmarks: window.landmarks.iter().map(|point| scale * point).collect(),
            }
        }),
        Wrong::new(
            &VELOCITIES_OMITTED,
            Functions {
                scaled_window: |window, scale| {
                    let before = window.states.clone();
                    let mut grown = right::scaled_window(window, scale);
                    for (state, before) in grown.states.iter_mut().zip(before) {
                        state.velocity = before.velocity;
                    }
                    grown
                },
                split_residual: |deltas, first, second, gravity| {
                    let still = |state| State { velocity: Vector3::zeros(), ..state };
                    moved(
                        right::split_residual(deltas, first, second, gravity),
                        right::split_residual(deltas, still(first), still(second), gravity).0,
                    )
                },
                ..REFERENCE
            },
        ),
        window(&POINTS_OMITTED, |window, scale| {
            let landmarks = window.landmarks.clone();
            Window { landmarks, ..right::scaled_window(window, scale) }
        }),
        parts(&GRAVITY_SCALED, |deltas, first, second, gravity| {
            let parts = right::split_residual(deltas, first, second, gravity);
            let weightless = right::split_residual(deltas, first, second, Vector3::zeros());
            let whole = parts.0 + parts.1;
            moved(parts, whole - weightless.1)
        }),
        parts(&DELTAS_SCALED, |deltas, first, second, gravity| {
            let parts = right::split_residual(deltas, first, second, gravity);
            let none = Deltas { velocity: Vector3::zeros(), position: Vector3::zeros(), ..deltas };
            let whole = parts.0 + parts.1;
            moved(parts, whole - right::split_residual(none, first, second, gravity).1)
        }),
        parts(&DELTAS_SCALED, |deltas, first, second, gravity| {
            let parts = right::split_residual(deltas, first, second, gravity);
            let still = Deltas { velocity: Vector3::zeros(), ..deltas };
            let whole = parts.0 + parts.1;
            moved(parts, whole - right::split_residual(still, first, second, gravity).1)
        }),
        parts(&ROTATION_SCALED, |deltas, first, second, gravity| {
            let (grows, stays) = right::split_residual(deltas, first, second, gravity);
            let with_rotation =
                Vector9::from_fn(|row, _| if row < 3 { stays[row] } else { grows[row] });
            moved((grows, stays), with_rotation)
        }),
        verdict(&HALF_FORGOTTEN, |intervals, gravity, tolerance| {
            judged(&intervals, &gravity, |[velocity, position], t| {
                velocity <= tolerance * t && position <= tolerance * t * t
            })
        }),
        parts(&HALF_FORGOTTEN, |deltas, first, second, gravity| {
            let (grows, mut stays) = right::split_residual(deltas, first, second, gravity);
            let heavier = right::split_residual(deltas, first, second, 2.0 * gravity).1;
            stays.fixed_rows_mut::<3>(6).copy_from(&heavier.fixed_rows::<3>(6));
            (grows, stays)
        }),
        verdict(&TIME_FORGOTTEN, |intervals, gravity, tolerance| {
            judged(&intervals, &gravity, |[velocity, position], t| {
                velocity <= tolerance && position <= 0.5 * tolerance * t * t
            })
        }),
        verdict(&TIME_FORGOTTEN, |intervals, gravity, tolerance| {
            judged(&intervals, &gravity, |[velocity, position], t| {
                velocity <= tolerance * t && position <= 0.5 * tolerance * t
            })
        }),
        verdict(&REST_FIXED, |intervals, gravity, tolerance| {
            right::scale_is_free(intervals, -gravity, tolerance)
        }),
        verdict(&GRAVITY_ALONE, |_, gravity, _| gravity.norm() == 0.0),
        verdict(&SILENT_ACCELEROMETER, |intervals, _, tolerance| {
            right::scale_is_free(intervals, Vector3::zeros(), tolerance)
        }),
        verdict(&ROTATION_FIXES_SCALE, |intervals, gravity, tolerance| {
            intervals.iter().all(|one| so3::log(&one.deltas.rotation).norm() < 1e-6)
                && right::scale_is_free(intervals, gravity, tolerance)
        }),
        verdict(&VELOCITY_ALONE, |intervals, gravity, tolerance| {
            judged(&intervals, &gravity, |[velocity, _], t| velocity <= tolerance * t)
        }),
        verdict(&EITHER_SUFFICES, |intervals, gravity, tolerance| {
            judged(&intervals, &gravity, |[velocity, position], t| {
                velocity <= tolerance * t || position <= 0.5 * tolerance * t * t
            })
        }),
        verdict(&ONE_INTERVAL_SUFFICES, |intervals, gravity, tolerance| {
            intervals.into_iter().any(|one| right::scale_is_free(vec![one], gravity, tolerance))
        }),
        verdict(&GRAVITY_IN_BODY, |intervals, gravity, tolerance| {
            let turned = |one: Interval| Interval {
                world_from_first: one.world_from_first.inverse(),
                ..one
            };
            right::scale_is_free(intervals.into_iter().map(turned).collect(), gravity, tolerance)
        }),
        verdict(&GRAVITY_IN_BODY, |intervals, gravity, tolerance| {
            let unturned =
                |one: Interval| Interval { world_from_first: Rotation3::identity(), ..one };
            right::scale_is_free(intervals.into_iter().map(unturned).collect(), gravity, tolerance)
        }),
    ]
}

/// Whether every interval is judged so: by what velocity and position change, and how long it is.
fn judged(
    intervals: &[Interval],
    gravity: &Vector3<f64>,
    judge: impl Fn([f64; 2], f64) -> bool,
) -> bool {
    intervals.iter().all(|Interval { world_from_first, deltas }| {
        let (t, gravity) = (deltas.duration, world_from_first.inverse() * gravity);
        let velocity = deltas.velocity + t * gravity;
        let position = deltas.position + 0.5 * t * t * gravity;
        judge([velocity.norm(), position.norm()], t)
    })
}

/// The same residual with another part of it said to grow.
fn moved((grows, stays): (Vector9, Vector9), instead: Vector9) -> (Vector9, Vector9) {
    (instead, grows + stays - instead)
}
