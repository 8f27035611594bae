//! Steps in the body frame. Edition 1.
//!
//! `cargo test -p exercises residual_jacobian`

use exercise_spec::residual_jacobian::{Deltas, Matrix9, State, Vector9};
use nalgebra::Vector3;

/// What two states say about the interval between them less what its readings say, seen from the
/// first body frame, in the order (φ, v, p): in radians, m/s and metres.
pub fn residual(deltas: Deltas, first: State, second: State, gravity: Vector3<f64>) -> Vector9 {
    let _ = (deltas, first, second, gravity);
    todo!("three differences: of the rotation, of the velocity and of the position")
}

/// The 9×9 derivative of the residual by a step (φ, δv, δp) of the first state in the body frame:
/// R exp(φ), v + R δv, p + R δp.
pub fn by_first(deltas: Deltas, first: State, second: State, gravity: Vector3<f64>) -> Matrix9 {
    let _ = (deltas, first, second, gravity);
    todo!("nine blocks, three of which are zero")
}

/// The derivative of something by a step of this state in the book's own convention, R exp(φ),
/// v + δv, p + δp, when its derivative by a step in the body frame is given.
pub fn by_world_steps(state: State, by_body_steps: Matrix9) -> Matrix9 {
    let _ = (state, by_body_steps);
    todo!("the dictionary between the two kinds of steps")
}
