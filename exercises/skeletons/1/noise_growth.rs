//! Where uncertainty comes from. Edition 1.
//!
//! `cargo test -p exercises noise_growth`

use exercise_spec::noise_growth::{Densities, Exponents, Reading, Source};
use nalgebra::Matrix6;

/// One step of the errors x = (φ, ν), both seen from the last body frame: F and G of
/// x' = F x + G η, where η = (η_g, η_a) is added to the reading.
pub fn error_step(reading: Reading, dt: f64) -> (Matrix6<f64>, Matrix6<f64>) {
    let _ = (reading, dt);
    todo!("what the old errors become, and what an error of the reading becomes")
}

/// The 6×6 covariance of (φ, ν) after one more step. Densities are continuous: a reading has
/// along each axis the variance σ²/dt.
pub fn next_covariance(
    covariance: Matrix6<f64>,
    reading: Reading,
    dt: f64,
    densities: Densities,
) -> Matrix6<f64> {
    let _ = (covariance, reading, dt, densities);
    todo!("the old covariance, carried along, and the noise of one reading")
}

/// The 6×6 covariance of (φ, ν) after all the readings, in their order. Before the first of them
/// nothing is uncertain.
pub fn covariance_of(readings: Vec<Reading>, dt: f64, densities: Densities) -> Matrix6<f64> {
    let _ = (readings, dt, densities);
    todo!("step after step")
}

/// The exponents of the standard deviations of attitude, velocity and position over the time,
/// for a body at rest. `None` where no single power holds or nothing varies.
pub fn predicted_exponents(source: Source) -> Exponents {
    let _ = source;
    todo!("three exponents for each source; predict them before you fit any")
}

/// The exponent q of the law σ = c tᵠ that fits best: the slope of the least-squares line through
/// the points (log t, log σ).
pub fn fitted_exponent(durations: Vec<f64>, sigmas: Vec<f64>) -> f64 {
    let _ = (durations, sigmas);
    todo!("the slope of a line")
}
