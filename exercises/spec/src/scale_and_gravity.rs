//! What happens to pictures and to inertial residuals when a whole window grows.

use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

pub use crate::navigation::{Deltas, State};
pub use vislam::preintegration::Vector9;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: window
/// A few states of a body with a camera in its origin, and points that it sees, in the world and
/// in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// In the order of time; there is at least one.
    pub states: Vec<State>,
    /// Positions of points.
    pub landmarks: Vec<Vector3<f64>>,
}
// ANCHOR_END: window

// ANCHOR: interval
/// The readings between two states, and how the body stands at their beginning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Takes coordinates of the body at the beginning to the world.
    pub world_from_first: Rotation3<f64>,
    /// The readings, summed up.
    pub deltas: Deltas,
}
// ANCHOR_END: interval

crate::signatures! {
    // ANCHOR: scaled_window
    /// The window made `scale` times as large, so that every picture of every state stays what
    /// it is. The position of the **first state** stays, because it is pinned; all other lengths
    /// grow by the factor, and everything takes as long as before. The order of states and
    /// landmarks stays. The factor is positive.
    fn scaled_window(window: Window, scale: f64) -> Window;
    // ANCHOR_END: scaled_window

    // ANCHOR: split
    /// The inertial residual of two states whose window is made s times as large, taken apart:
    /// the vectors a and b, in the order (φ, v, p), with r(s) = s a + b for every s.
    ///
    /// The residual is the book's: the rotation vector from ΔR to Rᵢᵀ Rⱼ, then, seen from the
    /// first body, vⱼ − vᵢ − g t less Δv, then pⱼ − pᵢ − vᵢ t − ½ g t² less Δp. Measurements stay
    /// what they are, and so does gravity, an acceleration in the world in m/s².
    fn split_residual(
        deltas: Deltas,
        first: State,
        second: State,
        gravity: Vector3<f64>,
    ) -> (Vector9, Vector9);
    // ANCHOR_END: split

    // ANCHOR: verdict
    /// Whether the readings leave the scale free, for states that agree with them and whose
    /// attitudes are exact. The biases are known and taken off.
    ///
    /// An interval leaves it free when the derivative of its residual by log s, at s = 1 and for
    /// states that agree with its readings, is no longer than what a constant acceleration of
    /// `tolerance` m/s² would add: `tolerance` t in velocity **and** ½ `tolerance` t² in
    /// position, as lengths of the vectors, where t is its duration. All intervals have their
    /// say about one and the same scale. There is at least one interval.
    fn scale_is_free(intervals: Vec<Interval>, gravity: Vector3<f64>, tolerance: f64) -> bool;
    // ANCHOR_END: verdict
}
