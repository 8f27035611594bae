//! Where uncertainty comes from. Edition 1.
//!
//! `cargo test -p exercises noise_growth`

use exercise_spec::noise_growth::{Densities, Exponents, Reading, Source};
use nalgebra::Matrix6;

/// One step of the errors x = (φ, ν) of the sums over readings, attitude first: the 6×6
/// matrices F and G of x' = F x + G η. Here η = (η_g, η_a) is an error added to the reading
/// of this step, gyroscope first.
///
/// Both errors are seen **from the last body frame**, that of the time reached: the sums
/// come out as ΔR exp(φ) and Δv + ΔR ν. After the step they are seen from the body at its
/// end. The step is ΔR' = ΔR exp(ω dt), Δv' = Δv + ΔR f dt, with the ΔR before the step in
/// both. Derivatives are taken where x and η are zero; ω dt need not be small.
pub fn error_step(reading: Reading, dt: f64) -> (Matrix6<f64>, Matrix6<f64>) {
    let _ = (reading, dt);
    todo!("what the old errors become, and what an error of the reading becomes")
}

/// The 6×6 covariance of (φ, ν) after one more step of `dt` seconds, in rad², rad m/s and
/// (m/s)². The noise of a reading is independent of all that was before, and has along each
/// axis the variance σ²/dt, where σ is the density.
pub fn next_covariance(
    covariance: Matrix6<f64>,
    reading: Reading,
    dt: f64,
    densities: Densities,
) -> Matrix6<f64> {
    let _ = (covariance, reading, dt, densities);
    todo!("the old covariance, carried along, and the noise of one reading")
}

/// The 6×6 covariance of (φ, ν) after all the readings, in their order, each of which holds
/// for `dt` seconds. Before the first of them nothing is uncertain.
pub fn covariance_of(readings: Vec<Reading>, dt: f64, densities: Densities) -> Matrix6<f64> {
    let _ = (readings, dt, densities);
    todo!("step after step")
}

/// The exponents of the standard deviations of attitude, velocity and position over the time
/// t of an interval, for a body **at rest** whose sensor has noise in the source given and
/// reads gravity; velocity and position are those across the vertical. For times of many
/// steps.
pub fn predicted_exponents(source: Source) -> Exponents {
    let _ = source;
    todo!("three exponents for each source; predict them before you fit any")
}

/// The exponent q of the law σ = c tᵠ that fits best: the slope of the straight line through
/// the points (log t, log σ) that has the least sum of squared vertical distances. There are
/// at least two different times, all positive, as are the standard deviations.
pub fn fitted_exponent(durations: Vec<f64>, sigmas: Vec<f64>) -> f64 {
    let _ = (durations, sigmas);
    todo!("the slope of a line")
}
