//! Steps in the body frame. Edition 1.
//!
//! `cargo test -p exercises residual_jacobian`

use exercise_spec::residual_jacobian::{Deltas, Matrix9, State, Vector9};
use nalgebra::Vector3;

/// What two states say about the interval between them less what its readings say, in the
/// order (φ, v, p), in radians, m/s and metres: φ in the axes of the last body, v and p seen
/// from the first.
///
/// Of the rotation it is the rotation vector φ for which ΔR exp(φ) is the rotation from the
/// last body frame to the first, as the states have it. Of velocity and position it is the
/// difference to Δv and Δp. The sums over the readings contain neither gravity nor the
/// velocity at the beginning. Gravity is an acceleration in the world, in m/s².
pub fn residual(deltas: Deltas, first: State, second: State, gravity: Vector3<f64>) -> Vector9 {
    let _ = (deltas, first, second, gravity);
    todo!("three differences: of the rotation, of the velocity and of the position")
}

/// The 9×9 derivative of the residual by a step (φ, δv, δp) of the **first** state, at zero,
/// for any residual, small or large. The step is in the body frame, all of it:
///
/// R becomes R exp(φ), v becomes v + R δv, and p becomes p + R δp, with the R before the
/// step. Rows and columns are in the order rotation, velocity, position.
pub fn by_first(deltas: Deltas, first: State, second: State, gravity: Vector3<f64>) -> Matrix9 {
    let _ = (deltas, first, second, gravity);
    todo!("block by block: which part of the residual knows of which part of the state?")
}

/// The derivative of something by a step of this state in the book's own convention, in
/// which R becomes R exp(φ), v becomes v + δv and p becomes p + δp, when its derivative by
/// a step in the body frame is given.
pub fn by_world_steps(state: State, by_body_steps: Matrix9) -> Matrix9 {
    let _ = (state, by_body_steps);
    todo!("the dictionary between the two kinds of steps")
}
