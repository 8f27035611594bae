//! Wrong answers to [`residual_jacobian`](crate::residual_jacobian).

use exercise_spec::residual_jacobian::*;
use nalgebra::{Matrix3, Vector3};
use vislam::manifold::so3;

use super::Wrong;
use crate::residual_jacobian as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    residual: right::residual,
    by_first: right::by_first,
    by_world_steps: right::by_world_steps,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let residual =
        |misconception, residual| Wrong::new(misconception, Functions { residual, ..REFERENCE });
    let jacobian =
        |misconception, by_first| Wrong::new(misconception, Functions { by_first, ..REFERENCE });
    let dictionary = |misconception, by_world_steps| {
        Wrong::new(misconception, Functions { by_world_steps, ..REFERENCE })
    };
    vec![
        Wrong::new(
            &GRAVITY_FORGOTTEN,
            Functions {
                residual: |deltas, first, second, _| {
                    right::residual(deltas, first, second, Vector3::zeros())
                },
                by_first: |deltas, first, second, _| {
                    right::by_first(deltas, first, second, Vector3::zeros())
                },
                ..REFERENCE
            },
        ),
        residual(&GRAVITY_SIGN, |deltas, first, second, gravity| {
            right::residual(deltas, first, second, -gravity)
        }),
        residual(&GRAVITY_SIGN, |deltas, first, second, gravity| {
            let mut residual = right::residual(deltas, first, second, gravity);
            let rising = right::residual(deltas, first, second, -gravity);
            residual.fixed_rows_mut::<3>(3).copy_from(&rising.fixed_rows::<3>(3));
            residual
        }),
        jacobian(&GRAVITY_SIGN, |deltas, first, second, gravity| {
            let mut jacobian = right::by_first(deltas, first, second, gravity);
            let rising = right::by_first(deltas, first, second, -gravity);
            jacobian.fixed_rows_mut::<3>(3).copy_from(&rising.fixed_rows::<3>(3));
            jacobian
        }),
        Wrong::new(
            &CARRY_FORGOTTEN,
            Functions {
                residual: |deltas, first, second, gravity| {
                    let mut residual = right::residual(deltas, first, second, gravity);
                    let carried = deltas.duration * first.velocity;
                    let seen = first.world_from_body.inverse() * carried;
                    let position = residual.fixed_rows::<3>(6) + seen;
                    residual.fixed_rows_mut::<3>(6).copy_from(&position);
                    residual
                },
                by_first: |deltas, first, second, gravity| {
                    let mut jacobian = right::by_first(deltas, first, second, gravity);
                    jacobian.fixed_view_mut::<3, 3>(6, 3).fill(0.0);
                    jacobian
                },
                ..REFERENCE
            },
        ),
        residual(&LEFT_IN_THE_WORLD, |deltas, first, second, gravity| {
            let mut residual = right::residual(deltas, first, second, gravity);
            for at in [3, 6] {
                let turned = first.world_from_body * residual.fixed_rows::<3>(at);
                residual.fixed_rows_mut::<3>(at).copy_from(&turned);
            }
            residual
        }),
        jacobian(&UNTRANSPOSED_BLOCK, |deltas, first, second, gravity| {
            let stated = first.world_from_body.inverse() * second.world_from_body;
            let phi = so3::local(&deltas.rotation, &stated);
            let block = -so3::right_jacobian_inverse(&phi) * stated.matrix();
            with_corner(right::by_first(deltas, first, second, gravity), &block)
        }),
        Wrong::new(
            &REVERSED,
            Functions {
                residual: |deltas, first, second, gravity| {
                    -right::residual(deltas, first, second, gravity)
                },
                by_first: |deltas, first, second, gravity| {
                    -right::by_first(deltas, first, second, gravity)
                },
                ..REFERENCE
            },
        ),
        residual(&OTHER_SIDE, |deltas, first, second, gravity| {
            let mut residual = right::residual(deltas, first, second, gravity);
            let stated = first.world_from_body.inverse() * second.world_from_body;
            let phi = so3::log(&(stated * deltas.rotation.inverse()));
            residual.fixed_rows_mut::<3>(0).copy_from(&phi);
            residual
        }),
        residual(&ROTATION_REVERSED, |deltas, first, second, gravity| {
            let mut residual = right::residual(deltas, first, second, gravity);
            residual.fixed_rows_mut::<3>(0).neg_mut();
            residual
        }),
        jacobian(&WORLD_STEPS, |deltas, first, second, gravity| {
            right::by_world_steps(first, right::by_first(deltas, first, second, gravity))
        }),
        jacobian(&INVERSE_JACOBIAN_FORGOTTEN, |deltas, first, second, gravity| {
            let back = second.world_from_body.inverse() * first.world_from_body;
            with_corner(right::by_first(deltas, first, second, gravity), &-back.matrix())
        }),
        jacobian(&LEFT_INVERSE_JACOBIAN, |deltas, first, second, gravity| {
            let stated = first.world_from_body.inverse() * second.world_from_body;
            let phi = so3::local(&deltas.rotation, &stated);
            let block = -so3::right_jacobian_inverse(&-phi) * stated.inverse().matrix();
            with_corner(right::by_first(deltas, first, second, gravity), &block)
        }),
        jacobian(&SKEW_SIGN, |deltas, first, second, gravity| {
            let mut jacobian = right::by_first(deltas, first, second, gravity);
            jacobian.fixed_view_mut::<6, 3>(3, 0).neg_mut();
            jacobian
        }),
        jacobian(&SKEW_SIGN, |deltas, first, second, gravity| {
            let mut jacobian = right::by_first(deltas, first, second, gravity);
            jacobian.fixed_view_mut::<3, 3>(6, 0).neg_mut();
            jacobian
        }),
        jacobian(&MEASURED_FOR_STATED, |deltas, first, second, gravity| {
            let mut jacobian = right::by_first(deltas, first, second, gravity);
            for (at, delta) in [(3, deltas.velocity), (6, deltas.position)] {
                jacobian.fixed_view_mut::<3, 3>(at, 0).copy_from(&so3::hat(&delta));
            }
            jacobian
        }),
        jacobian(&DIFFERENCED, |deltas, first, second, gravity| {
            const H: f64 = 1e-3;
            let moved = |axis: usize, size: f64| {
                let step = size * Vector3::ith(axis % 3, 1.0);
                let turn = first.world_from_body;
                let first = match axis / 3 {
                    0 => State { world_from_body: so3::retract(&turn, &step), ..first },
                    1 => State { velocity: first.velocity + turn * step, ..first },
                    _ => State { position: first.position + turn * step, ..first },
                };
                right::residual(deltas, first, second, gravity)
            };
            Matrix9::from_columns(&[0, 1, 2, 3, 4, 5, 6, 7, 8].map(|axis| {
                let near = moved(axis, H) - moved(axis, -H);
                let far = moved(axis, 2.0 * H) - moved(axis, -2.0 * H);
                (8.0 * near - far) / (12.0 * H)
            }))
        }),
        dictionary(&INVERSE_DICTIONARY, |state, by_body_steps| {
            let world_from_body = state.world_from_body.inverse();
            right::by_world_steps(State { world_from_body, ..state }, by_body_steps)
        }),
        dictionary(&ROTATION_TURNED_TOO, |state, by_body_steps| {
            let mut jacobian = right::by_world_steps(state, by_body_steps);
            let turned =
                jacobian.fixed_columns::<3>(0) * state.world_from_body.matrix().transpose();
            jacobian.fixed_columns_mut::<3>(0).copy_from(&turned);
            jacobian
        }),
    ]
}

fn with_corner(mut jacobian: Matrix9, block: &Matrix3<f64>) -> Matrix9 {
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(block);
    jacobian
}
