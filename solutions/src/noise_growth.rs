//! Where uncertainty comes from.

use exercise_spec::noise_growth::{Densities, Exponents, Reading, Source};
use nalgebra::{Matrix6, Vector6};
use vislam::manifold::so3;

/// One step of the errors x = (φ, ν) of the sums over readings, attitude first: the 6×6
/// matrices F and G of x' = F x + G η. Here η = (η_g, η_a) is an error added to the reading
/// of this step, gyroscope first.
///
/// Both errors are seen **from the last body frame**, that of the time reached: the sums
/// come out as ΔR exp(φ) and Δv + ΔR ν. After the step they are seen from the body at its
/// end. The step is ΔR' = ΔR exp(ω dt), Δv' = Δv + ΔR f dt, with the ΔR before the step in
/// both. Derivatives are taken where x and η are zero; ω dt need not be small.
pub fn error_step(reading: Reading, dt: f64) -> (Matrix6<f64>, Matrix6<f64>) {
    let turn = dt * reading.gyro;
    // Takes what the body saw before the step to what it sees after it.
    let after_from_before = so3::exp(&turn).inverse().into_inner();
    let leak = -dt * after_from_before * so3::hat(&reading.force);
    let mut from_errors = Matrix6::zeros();
    from_errors.fixed_view_mut::<3, 3>(0, 0).copy_from(&after_from_before);
    from_errors.fixed_view_mut::<3, 3>(3, 0).copy_from(&leak);
    from_errors.fixed_view_mut::<3, 3>(3, 3).copy_from(&after_from_before);
    let mut from_reading = Matrix6::zeros();
    from_reading.fixed_view_mut::<3, 3>(0, 0).copy_from(&(dt * so3::right_jacobian(&turn)));
    from_reading.fixed_view_mut::<3, 3>(3, 3).copy_from(&(dt * after_from_before));
    (from_errors, from_reading)
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
    let (from_errors, from_reading) = error_step(reading, dt);
    let (gyro, force) = (densities.gyro.powi(2) / dt, densities.accelerometer.powi(2) / dt);
    let of_reading = Matrix6::from_diagonal(&Vector6::new(gyro, gyro, gyro, force, force, force));
    from_errors * covariance * from_errors.transpose()
        + from_reading * of_reading * from_reading.transpose()
}

/// The 6×6 covariance of (φ, ν) after all the readings, in their order, each of which holds
/// for `dt` seconds. Before the first of them nothing is uncertain.
pub fn covariance_of(readings: Vec<Reading>, dt: f64, densities: Densities) -> Matrix6<f64> {
    readings.into_iter().fold(Matrix6::zeros(), |covariance, reading| {
        next_covariance(covariance, reading, dt, densities)
    })
}

/// The exponents of the standard deviations of attitude, velocity and position over the time
/// t of an interval, for a body **at rest** whose sensor has noise in the source given and
/// reads gravity; velocity and position are those across the vertical. For times of many
/// steps.
pub fn predicted_exponents(source: Source) -> Exponents {
    let (attitude, velocity, position) = match source {
        Source::Accelerometer => (None, Some(0.5), Some(1.5)),
        Source::Gyroscope => (Some(0.5), Some(1.5), Some(2.5)),
        Source::Both => (Some(0.5), None, None),
    };
    Exponents { attitude, velocity, position }
}

/// The exponent q of the law σ = c tᵠ that fits best: the slope of the straight line through
/// the points (log t, log σ) that has the least sum of squared vertical distances. There are
/// at least two different times, all positive, as are the standard deviations.
pub fn fitted_exponent(durations: Vec<f64>, sigmas: Vec<f64>) -> f64 {
    let centred = |list: Vec<f64>| {
        let logs: Vec<f64> = list.into_iter().map(f64::ln).collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        logs.into_iter().map(move |log| log - mean).collect::<Vec<f64>>()
    };
    let (x, y) = (centred(durations), centred(sigmas));
    let sum_of_products = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    sum_of_products(&x, &y) / sum_of_products(&x, &x)
}
