//! What a filter promises. Edition 2.
//!
//! `cargo test -p exercises nees_diagnosis`

use exercise_spec::nees_diagnosis::{Campaign, Fault, Matrix9, Parts, State};
use nalgebra::Vector3;

/// The NEES of an estimate in parts: eᵀ P⁻¹ e / d for an error e of d numbers, P being the
/// covariance of these numbers.
///
/// `covariance` is that of the step (φ, ν, ρ), in this order, from the estimate to the truth,
/// all of it **in the body frame of the estimate**: R̂ exp(φ) is the true rotation, v̂ + R̂ ν the
/// true velocity, p̂ + R̂ ρ the true position. It is positive definite.
///
/// Tilt and yaw are parts of the rotation that the **world** sees, the rotation vector θ of
/// exp(θ) R̂, which is the true rotation. Yaw is its coordinate along `up`, a vector of length
/// one in the world, which need not be an axis of the world. Tilt are its coordinates along
/// two horizontal axes at right angles to each other; it does not matter which.
pub fn parts_of(estimate: State, truth: State, covariance: Matrix9, up: Vector3<f64>) -> Parts {
    let _ = (estimate, truth, covariance, up);
    todo!("each part with the covariance of its own numbers")
}

/// The lower and the upper end of the band in which a mean of NEES or NIS lies when the filter
/// is consistent. Its errors are normal and independent from run to run.
///
/// Run k has an error of `dimensions[k]` numbers. The mean is the sum of all eᵀ P⁻¹ e, over the
/// runs, divided by the sum of their dimensions. So many `tests` are made like this one, and a
/// consistent filter may leave any of their bands with the probability `outside` at most:
/// every end of every band has an equal share of it. There is at least one run and one test,
/// no dimension is zero, and `outside` is between zero and one.
pub fn band(dimensions: Vec<usize>, tests: usize, outside: f64) -> (f64, f64) {
    let _ = (dimensions, tests, outside);
    todo!("two ends")
}

/// Which fault the filter of a campaign has. It has one at most.
///
/// Every number of every report is a test, and `outside` is the probability with which all of
/// them together may call a consistent filter faulty. So the verdict is [`Fault::None`] when
/// every number lies in its band, and never otherwise.
pub fn diagnosis(campaign: Campaign, outside: f64) -> Fault {
    let _ = (campaign, outside);
    todo!("the fault that these numbers speak of")
}
