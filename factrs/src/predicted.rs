//! How far preintegration in the tangent space, as factrs and GTSAM do it, is from the book's on the group.

use nalgebra::{Matrix3, Vector3};
use vislam::manifold::so3;

// ANCHOR: overshoot
/// By how much the rotation vector of Euler's rule in the tangent space exceeds that of the readings, to leading order
/// in the turn, from the rates of the readings and the seconds of each. Implements {eq:tangent-overshoot}.
pub fn overshoot(rates: &[Vector3<f64>], dt: f64) -> Vector3<f64> {
    summed(rates, dt, |turn, rate| rate.cross(&turn.cross(rate)))
}

/// A term of turn and rate, summed over the readings, times Δt²/12.
pub fn summed(
    rates: &[Vector3<f64>],
    dt: f64,
    term: impl Fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>,
) -> Vector3<f64> {
    let (mut turn, mut sum) = (Vector3::zeros(), Vector3::zeros());
    for rate in rates {
        sum += term(&turn, rate);
        turn += dt * rate;
    }
    dt * dt / 12.0 * sum
}
// ANCHOR_END: overshoot

/// The covariance of θ when exp(θ) is followed by a small turn of this covariance. Implements
/// {eq:tangent-covariance}.
pub fn tangent_covariance(turn: &Vector3<f64>, covariance: &Matrix3<f64>) -> Matrix3<f64> {
    let jacobian = so3::right_jacobian_inverse(turn);
    jacobian * covariance * jacobian.transpose()
}
