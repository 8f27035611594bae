//! Where uncertainty comes from: how noise enters the sums over readings, and how it grows.

use nalgebra::{Matrix6, Vector3};
use serde::{Deserialize, Serialize};

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: data
/// What a sensor reads, free of bias, in the body frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Angular velocity, in rad/s.
    pub gyro: Vector3<f64>,
    /// Specific force, in m/s².
    pub force: Vector3<f64>,
}

/// White noise of the two sensors as continuous densities, the same along all axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Densities {
    /// In rad/s/√Hz.
    pub gyro: f64,
    /// In m/s²/√Hz.
    pub accelerometer: f64,
}
// ANCHOR_END: data

// ANCHOR: exponents
/// Which sensor is noisy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// The accelerometer alone.
    Accelerometer,
    /// The gyroscope alone.
    Gyroscope,
    /// Both, neither of them negligible.
    Both,
}

/// Exponents q of the laws σ ∝ tᵠ by which standard deviations grow. `None` where no single
/// power of the time holds, or where the standard deviation stays zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exponents {
    /// Of the attitude.
    pub attitude: Option<f64>,
    /// Of the velocity.
    pub velocity: Option<f64>,
    /// Of the position.
    pub position: Option<f64>,
}
// ANCHOR_END: exponents

crate::signatures! {
    // ANCHOR: signatures
    /// One step of the errors x = (φ, ν) of the sums over readings, attitude first: the 6×6
    /// matrices F and G of x' = F x + G η. Here η = (η_g, η_a) is an error added to the reading
    /// of this step, gyroscope first.
    ///
    /// Both errors are seen **from the last body frame**, that of the time reached: the sums
    /// come out as ΔR exp(φ) and Δv + ΔR ν. After the step they are seen from the body at its
    /// end. The step is ΔR' = ΔR exp(ω dt), Δv' = Δv + ΔR f dt, with the ΔR before the step in
    /// both. Derivatives are taken where x and η are zero; ω dt need not be small.
    fn error_step(reading: Reading, dt: f64) -> (Matrix6<f64>, Matrix6<f64>);

    /// The 6×6 covariance of (φ, ν) after one more step of `dt` seconds, in rad², rad m/s and
    /// (m/s)². The noise of a reading is independent of all that was before, and has along each
    /// axis the variance σ²/dt, where σ is the density.
    fn next_covariance(
        covariance: Matrix6<f64>,
        reading: Reading,
        dt: f64,
        densities: Densities,
    ) -> Matrix6<f64>;
    // ANCHOR_END: signatures

    // ANCHOR: whole
    /// The 6×6 covariance of (φ, ν) after all the readings, in their order, each of which holds
    /// for `dt` seconds. Before the first of them nothing is uncertain.
    fn covariance_of(readings: Vec<Reading>, dt: f64, densities: Densities) -> Matrix6<f64>;
    // ANCHOR_END: whole

    // ANCHOR: growth
    /// The exponents of the standard deviations of attitude, velocity and position over the time
    /// t of an interval, for a body **at rest** whose sensor has noise in the source given and
    /// reads gravity; velocity and position are those across the vertical. For times of many
    /// steps.
    fn predicted_exponents(source: Source) -> Exponents;

    /// The exponent q of the law σ = c tᵠ that fits best: the slope of the straight line through
    /// the points (log t, log σ) that has the least sum of squared vertical distances. There are
    /// at least two different times, all positive, as are the standard deviations.
    fn fitted_exponent(durations: Vec<f64>, sigmas: Vec<f64>) -> f64;
    // ANCHOR_END: growth
}
