//! What fixes the scale. Edition 1.
//!
//! `cargo test -p exercises scale_and_gravity`

use exercise_spec::scale_and_gravity::{Deltas, Interval, State, Vector9, Window};
use nalgebra::Vector3;

/// The window made `scale` times as large, so that every picture of every state stays what
/// it is. The position of the **first state** stays, because it is pinned; all other lengths
/// grow by the factor, and everything takes as long as before. The order of states and
/// landmarks stays. The factor is positive.
pub fn scaled_window(window: Window, scale: f64) -> Window {
    let _ = (window, scale);
    todo!("the same window, larger: what grows, about which point, and what does not?")
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
    let _ = (deltas, first, second, gravity);
    todo!("what grows with the scale, and what stays")
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
    let _ = (intervals, gravity, tolerance);
    todo!("a verdict from readings, gravity and the rotation at the beginning")
}
