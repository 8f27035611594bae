//! What fixes the scale.

use exercise_spec::scale_and_gravity::{Deltas, Interval, State, Vector9, Window};
use nalgebra::Vector3;
use vislam::manifold::so3;

/// The window made `scale` times as large, so that every picture of every state stays what
/// it is. The position of the **first state** stays, because it is pinned; all other lengths
/// grow by the factor, and everything takes as long as before. The order of states and
/// landmarks stays. The factor is positive.
pub fn scaled_window(window: Window, scale: f64) -> Window {
    let Some(first) = window.states.first() else { return window };
    let centre = first.position;
    let grown = |point: Vector3<f64>| centre + scale * (point - centre);
    let state = |state: State| State {
        velocity: scale * state.velocity,
        position: grown(state.position),
        ..state
    };
    Window {
        states: window.states.into_iter().map(state).collect(),
        landmarks: window.landmarks.into_iter().map(grown).collect(),
    }
}

/// The inertial residual of two states whose window is made s times as large, taken apart:
/// the vectors a and b, in the order (φ, v, p), with r(s) = s a + b for every s.
///
/// The residual is the book's: the rotation vector from ΔR to Rᵢᵀ Rⱼ, then, seen from the
/// first body, vⱼ − vᵢ − g t less Δv, then pⱼ − pᵢ − vᵢ t − ½ g t² less Δp. Measurements stay
/// what they are, and so does gravity, an acceleration in the world in m/s².
pub fn split_residual(
    deltas: Deltas,
    first: State,
    second: State,
    gravity: Vector3<f64>,
) -> (Vector9, Vector9) {
    let (t, body_from_world) = (deltas.duration, first.world_from_body.inverse());
    let came = second.position - first.position - t * first.velocity;
    let grows = stack(
        &Vector3::zeros(),
        &(body_from_world * (second.velocity - first.velocity)),
        &(body_from_world * came),
    );
    let phi = so3::local(&deltas.rotation, &(body_from_world * second.world_from_body));
    let [velocity, position] = pair(&deltas, &(body_from_world * gravity));
    (grows, stack(&phi, &-velocity, &-position))
}

/// Whether the readings leave the scale free, for states that agree with them and whose
/// attitudes are exact. The biases are known and taken off.
///
/// An interval leaves it free when the derivative of its residual by log s, at s = 1 and for
/// states that agree with its readings, is no longer than what a constant acceleration of
/// `tolerance` m/s² would add: `tolerance` t in velocity **and** ½ `tolerance` t² in
/// position, as lengths of the vectors, where t is its duration. All intervals have their
/// say about one and the same scale. There is at least one interval.
pub fn scale_is_free(intervals: Vec<Interval>, gravity: Vector3<f64>, tolerance: f64) -> bool {
    intervals.iter().all(|Interval { world_from_first, deltas }| {
        let t = deltas.duration;
        let [velocity, position] = pair(deltas, &(world_from_first.inverse() * gravity));
        velocity.norm() <= tolerance * t && position.norm() <= 0.5 * tolerance * t * t
    })
}

/// What the readings and gravity together say that a body does beyond coasting: the pair that does
/// not grow with the window. In the first body frame, gravity too.
fn pair(deltas: &Deltas, gravity: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let t = deltas.duration;
    [deltas.velocity + t * gravity, deltas.position + 0.5 * t * t * gravity]
}

fn stack(phi: &Vector3<f64>, velocity: &Vector3<f64>, position: &Vector3<f64>) -> Vector9 {
    let parts = [phi, velocity, position];
    Vector9::from_fn(|row, _| parts[row / 3][row % 3])
}
