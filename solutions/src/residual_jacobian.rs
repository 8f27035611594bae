//! Steps in the body frame.

use exercise_spec::residual_jacobian::{Deltas, Matrix9, State, Vector9};
use nalgebra::{Matrix3, Rotation3, Vector3};
use vislam::manifold::so3;

/// What two states say about the interval between them less what its readings say, in the
/// order (φ, v, p), in radians, m/s and metres: φ in the axes of the last body, v and p seen
/// from the first.
///
/// Of the rotation it is the rotation vector φ for which ΔR exp(φ) is the rotation from the
/// last body frame to the first, as the states have it. Of velocity and position it is the
/// difference to Δv and Δp. The sums over the readings contain neither gravity nor the
/// velocity at the beginning. Gravity is an acceleration in the world, in m/s².
pub fn residual(deltas: Deltas, first: State, second: State, gravity: Vector3<f64>) -> Vector9 {
    let stated = stated(deltas.duration, &first, &second, &gravity);
    let mut residual = Vector9::zeros();
    residual.fixed_rows_mut::<3>(0).copy_from(&so3::local(&deltas.rotation, &stated.rotation));
    residual.fixed_rows_mut::<3>(3).copy_from(&(stated.velocity - deltas.velocity));
    residual.fixed_rows_mut::<3>(6).copy_from(&(stated.position - deltas.position));
    residual
}

/// The 9×9 derivative of the residual by a step (φ, δv, δp) of the **first** state, at zero,
/// for any residual, small or large. The step is in the body frame, all of it:
///
/// R becomes R exp(φ), v becomes v + R δv, and p becomes p + R δp, with the R before the
/// step. Rows and columns are in the order rotation, velocity, position.
pub fn by_first(deltas: Deltas, first: State, second: State, gravity: Vector3<f64>) -> Matrix9 {
    let stated = stated(deltas.duration, &first, &second, &gravity);
    let phi = so3::local(&deltas.rotation, &stated.rotation);
    let turned = -so3::right_jacobian_inverse(&phi) * stated.rotation.inverse().matrix();
    // The rotation of the first body meets its own transpose in all other blocks.
    let minus = -Matrix3::identity();
    let mut jacobian = Matrix9::zeros();
    let mut put = |row, column, block: &Matrix3<f64>| {
        jacobian.fixed_view_mut::<3, 3>(row, column).copy_from(block);
    };
    put(0, 0, &turned);
    put(3, 0, &so3::hat(&stated.velocity));
    put(6, 0, &so3::hat(&stated.position));
    put(3, 3, &minus);
    put(6, 3, &(deltas.duration * minus));
    put(6, 6, &minus);
    jacobian
}

/// The derivative of something by a step of this state in the book's own convention, in
/// which R becomes R exp(φ), v becomes v + δv and p becomes p + δp, when its derivative by
/// a step in the body frame is given.
pub fn by_world_steps(state: State, by_body_steps: Matrix9) -> Matrix9 {
    let body_from_world = state.world_from_body.inverse();
    let mut body_from_world_steps = Matrix9::identity();
    for at in [3, 6] {
        let mut block = body_from_world_steps.fixed_view_mut::<3, 3>(at, at);
        block.copy_from(body_from_world.matrix());
    }
    by_body_steps * body_from_world_steps
}

/// What two states say that the deltas should be.
struct Stated {
    rotation: Rotation3<f64>,
    velocity: Vector3<f64>,
    position: Vector3<f64>,
}

fn stated(t: f64, first: &State, second: &State, gravity: &Vector3<f64>) -> Stated {
    let body_from_world = first.world_from_body.inverse();
    // Where the first state would be by now, and how fast, if nothing but gravity acted.
    let fallen_velocity = first.velocity + t * gravity;
    let fallen_position = first.position + t * first.velocity + 0.5 * t * t * gravity;
    Stated {
        rotation: body_from_world * second.world_from_body,
        velocity: body_from_world * (second.velocity - fallen_velocity),
        position: body_from_world * (second.position - fallen_position),
    }
}
