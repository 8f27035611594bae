//! The error of a state, in the world.

use nalgebra::{Matrix, Matrix3, Storage, U3, Vector2, Vector3};

use crate::inertial::NavState;
use crate::manifold::so3;

// ANCHOR: state_error
/// What has to be added to an estimated state to get the true one, all of it in the world.
///
/// The estimate's own error φ stands in the frame of the body, R = R̂ exp(φ^). The same turn seen
/// from the world is exp(R̂ φ^ R̂ᵀ) R̂ = exp((R̂ φ)^) R̂, and R̂ φ is what stands here. Its vertical
/// coordinate is the error in yaw, the two others are the error in tilt. Nothing in it depends on
/// how the axes of the body were chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateError {
    /// Rotation vector in the world, in radians, to be applied from the left.
    pub rotation: Vector3<f64>,
    /// In m/s.
    pub velocity: Vector3<f64>,
    /// In metres.
    pub position: Vector3<f64>,
}
// ANCHOR_END: state_error

impl StateError {
    // ANCHOR: between
    /// The error of an estimate.
    pub fn between(estimate: &NavState, truth: &NavState) -> Self {
        let in_body = so3::local(&estimate.world_from_body, &truth.world_from_body);
        Self {
            rotation: estimate.world_from_body * in_body,
            velocity: truth.velocity - estimate.velocity,
            position: truth.position - estimate.position,
        }
    }
    // ANCHOR_END: between

    /// About the vertical, in radians.
    pub fn yaw(&self) -> f64 {
        self.rotation.z
    }

    /// About the horizontal axes x and y of the world, in radians.
    pub fn tilt(&self) -> Vector2<f64> {
        self.rotation.xy()
    }
}

// ANCHOR: attitude_in_world
/// The 3×3 covariance of [`StateError::rotation`], in rad²: that of the turn R̂ φ in the world is
/// R̂ P R̂ᵀ, for the covariance P of the turn φ in the body. Its last diagonal entry is the variance
/// of yaw.
///
/// `covariance` is P, the first 3×3 block of a covariance of the estimate's step.
pub fn attitude_in_world(
    estimate: &NavState,
    covariance: &Matrix<f64, U3, U3, impl Storage<f64, U3, U3>>,
) -> Matrix3<f64> {
    let world_from_body = estimate.world_from_body.matrix();
    let turned = world_from_body * covariance * world_from_body.transpose();
    0.5 * (turned + turned.transpose())
}
// ANCHOR_END: attitude_in_world

/// Roots of the mean squares of errors, each of the length of the vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RootMeanSquares {
    /// In metres.
    pub position: f64,
    /// In m/s.
    pub velocity: f64,
    /// Of the whole angle, in radians.
    pub rotation: f64,
    /// Of the part of it about horizontal axes, in radians.
    pub tilt: f64,
    /// Of the part of it about the vertical, in radians.
    pub yaw: f64,
}

impl RootMeanSquares {
    // ANCHOR: root_mean_squares
    /// Over these errors, or `None` when there are none.
    pub fn of(errors: &[StateError]) -> Option<Self> {
        let root = |square: fn(&StateError) -> f64| {
            (errors.iter().map(square).sum::<f64>() / errors.len() as f64).sqrt()
        };
        (!errors.is_empty()).then(|| Self {
            position: root(|error| error.position.norm_squared()),
            velocity: root(|error| error.velocity.norm_squared()),
            rotation: root(|error| error.rotation.norm_squared()),
            tilt: root(|error| error.tilt().norm_squared()),
            yaw: root(|error| error.yaw().powi(2)),
        })
    }
    // ANCHOR_END: root_mean_squares
}
