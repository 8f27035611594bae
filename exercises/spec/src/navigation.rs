//! States of a body and preintegrated readings as plain data.

use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub(crate) use checks::given;

// ANCHOR: state
/// Where a body is, how it is turned and how fast it goes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The rotation that takes body coordinates to world coordinates.
    pub world_from_body: Rotation3<f64>,
    /// Velocity in the world, in m/s.
    pub velocity: Vector3<f64>,
    /// Position in the world, in metres.
    pub position: Vector3<f64>,
}

/// What the readings of an interval say about it, without gravity and without the velocity at
/// its beginning. The bias is known and taken off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Deltas {
    /// Length of the interval, in seconds.
    pub duration: f64,
    /// Takes coordinates of the last body frame to the first.
    pub rotation: Rotation3<f64>,
    /// In the first body frame, in m/s.
    pub velocity: Vector3<f64>,
    /// In the first body frame, in metres.
    pub position: Vector3<f64>,
}
// ANCHOR_END: state
