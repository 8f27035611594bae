//! How errors of the deltas go from one step to the next, as the derivation writes it.

use nalgebra::{Matrix3, Rotation3};

use super::{Matrix9, Matrix9x6, Rule};
use crate::inertial::ImuSample;
use crate::manifold::so3;

// ANCHOR: error_dynamics
/// One step of the errors: (φ, v, p) becomes A (φ, v, p) + B η, where η is added to the reading,
/// gyroscope first. A bias is subtracted, so its Jacobian becomes A J − B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorDynamics {
    /// The 9×9 matrix A.
    pub from_errors: Matrix9,
    /// The 9×6 matrix B.
    pub from_reading: Matrix9x6,
}

// ANCHOR_END: error_dynamics

/// The dynamics of a step of `dt` seconds from the delta `rotation`, with a reading free of bias.
/// With [`Rule::Midpoint`] that is the mean of the two.
///
/// Implements {eq:error-dynamics-blocks}, and {eq:error-dynamics-midpoint} for the midpoint rule.
/// With these matrices a covariance goes on by {eq:covariance-recursion}.
///
/// [`Preintegrator`](super::Preintegrator) computes the same without zeros and ones.
// ANCHOR: dynamics_of_a_step
pub fn error_dynamics(
    rule: Rule,
    rotation: &Rotation3<f64>,
    sample: &ImuSample,
    dt: f64,
) -> ErrorDynamics {
    let (turn, right_jacobian) = so3::exp_with_right_jacobian(&(dt * sample.gyro));
    let before_force = match rule {
        Rule::Euler => 0.0,
        Rule::Midpoint => 0.5 * dt,
    };
    let before = before_force * sample.gyro;
    let along = rotation * so3::exp(&before);
    let force = so3::hat(&(so3::exp(&before) * sample.accelerometer));
    let leak = -dt * (rotation.matrix() * force);
    let turning = before_force * (leak * so3::left_jacobian(&before));
    assemble(&turn, &leak, dt, &[dt * right_jacobian, turning, dt * along.matrix()])
}
// ANCHOR_END: dynamics_of_a_step

// ANCHOR: dynamics_blocks
/// The matrices from their blocks. `reading` holds the derivatives of φ and v by the angular
/// velocity and of v by the force. Position gains half of what velocity gains, times `dt`.
fn assemble(
    turn: &Rotation3<f64>,
    leak: &Matrix3<f64>,
    dt: f64,
    reading: &[Matrix3<f64>; 3],
) -> ErrorDynamics {
    let [phi_gyro, velocity_gyro, velocity_accelerometer] = reading;
    let mut a = Matrix9::identity();
    a.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn.matrix().transpose());
    a.fixed_view_mut::<3, 3>(3, 0).copy_from(leak);
    a.fixed_view_mut::<3, 3>(6, 0).copy_from(&(0.5 * dt * leak));
    a.fixed_view_mut::<3, 3>(6, 3).fill_diagonal(dt);
    let mut b = Matrix9x6::zeros();
    b.fixed_view_mut::<3, 3>(0, 0).copy_from(phi_gyro);
    b.fixed_view_mut::<3, 3>(3, 0).copy_from(velocity_gyro);
    b.fixed_view_mut::<3, 3>(6, 0).copy_from(&(0.5 * dt * velocity_gyro));
    b.fixed_view_mut::<3, 3>(3, 3).copy_from(velocity_accelerometer);
    b.fixed_view_mut::<3, 3>(6, 3).copy_from(&(0.5 * dt * velocity_accelerometer));
    ErrorDynamics { from_errors: a, from_reading: b }
}
// ANCHOR_END: dynamics_blocks
