//! Wrong answers to [`noise_growth`](crate::noise_growth).

use std::f64::consts::LN_10;

use exercise_spec::noise_growth::*;
use nalgebra::{Matrix3, Matrix6, Vector6};
use vislam::manifold::so3;

use super::Wrong;
use crate::noise_growth as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    error_step: right::error_step,
    next_covariance: right::next_covariance,
    covariance_of: right::covariance_of,
    predicted_exponents: right::predicted_exponents,
    fitted_exponent: right::fitted_exponent,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let step = |misconception, error_step| {
        Wrong::new(misconception, Functions { error_step, ..REFERENCE })
    };
    let covariance = |misconception, next_covariance| {
        Wrong::new(misconception, Functions { next_covariance, ..REFERENCE })
    };
    let whole = |misconception, covariance_of| {
        Wrong::new(misconception, Functions { covariance_of, ..REFERENCE })
    };
    let exponents = |misconception, predicted_exponents| {
        Wrong::new(misconception, Functions { predicted_exponents, ..REFERENCE })
    };
    let fit = |misconception, fitted_exponent| {
        Wrong::new(misconception, Functions { fitted_exponent, ..REFERENCE })
    };
    vec![
        step(&UNTRANSPOSED_BLOCK, |reading, dt| {
            let turn = so3::exp(&(dt * reading.gyro)).into_inner();
            blocks(&reading, dt, &turn, &(-dt * turn * so3::hat(&reading.force)), &turn)
        }),
        step(&VELOCITY_NOT_TURNED, |reading, dt| {
            let back = so3::exp(&(-dt * reading.gyro)).into_inner();
            blocks(&reading, dt, &back, &(-dt * so3::hat(&reading.force)), &Matrix3::identity())
        }),
        step(&LEAK_SIGN, |reading, dt| {
            let (mut f, g) = right::error_step(reading, dt);
            f.fixed_view_mut::<3, 3>(3, 0).neg_mut();
            (f, g)
        }),
        step(&ROTATION_TOO_EARLY, |reading, dt| {
            let back = so3::exp(&(-dt * reading.gyro)).into_inner();
            let force = so3::hat(&reading.force);
            let (mut f, mut g) =
                blocks(&reading, dt, &back, &(-dt * force * back), &Matrix3::identity());
            f.fixed_view_mut::<3, 3>(3, 3).copy_from(&back);
            let tilted = -dt * dt * force * so3::right_jacobian(&(dt * reading.gyro));
            g.fixed_view_mut::<3, 3>(3, 0).copy_from(&tilted);
            (f, g)
        }),
        step(&LEAK_NOT_TURNED, |reading, dt| {
            let (mut f, g) = right::error_step(reading, dt);
            f.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-dt * so3::hat(&reading.force)));
            (f, g)
        }),
        step(&LEAK_WITHOUT_STEP, |reading, dt| {
            let (mut f, g) = right::error_step(reading, dt);
            let back = so3::exp(&(-dt * reading.gyro)).into_inner();
            f.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-back * so3::hat(&reading.force)));
            (f, g)
        }),
        step(&RIGHT_JACOBIAN_FORGOTTEN, |reading, dt| {
            let (f, mut g) = right::error_step(reading, dt);
            g.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::from_diagonal_element(dt));
            (f, g)
        }),
        step(&LEFT_JACOBIAN, |reading, dt| {
            let (f, mut g) = right::error_step(reading, dt);
            let left = dt * so3::right_jacobian(&(-dt * reading.gyro));
            g.fixed_view_mut::<3, 3>(0, 0).copy_from(&left);
            (f, g)
        }),
        step(&DIFFERENCED, |reading, dt| {
            const H: f64 = 1e-3;
            let slopes = |moved: &dyn Fn(&Vector6<f64>) -> Vector6<f64>| {
                Matrix6::from_columns(&[0, 1, 2, 3, 4, 5].map(|axis| {
                    let at = |size: f64| moved(&(size * Vector6::ith(axis, 1.0)));
                    (8.0 * (at(H) - at(-H)) - (at(2.0 * H) - at(-2.0 * H))) / (12.0 * H)
                }))
            };
            let none = Vector6::zeros();
            (
                slopes(&|before| error_after(&reading, dt, before, &none)),
                slopes(&|noise| error_after(&reading, dt, &none, noise)),
            )
        }),
        step(&SQUARED_STEP, |reading, dt| {
            let (mut f, g) = right::error_step(reading, dt);
            f.fixed_view_mut::<3, 3>(3, 0).scale_mut(dt);
            (f, g)
        }),
        Wrong::new(
            &DENSITY_PER_SAMPLE,
            Functions {
                next_covariance: |before, reading, dt, densities| {
                    next(&before, &reading, dt, &densities, 1.0)
                },
                covariance_of: |readings, dt, densities| {
                    readings.iter().fold(Matrix6::zeros(), |before, reading| {
                        next(&before, reading, dt, &densities, 1.0)
                    })
                },
                ..REFERENCE
            },
        ),
        covariance(&DENSITY_TIMES_STEP, |before, reading, dt, densities| {
            next(&before, &reading, dt, &densities, dt)
        }),
        covariance(&ONE_DENSITY, |before, reading, dt, densities| {
            let one = Densities { accelerometer: densities.gyro, ..densities };
            right::next_covariance(before, reading, dt, one)
        }),
        covariance(&ONE_DENSITY, |before, reading, dt, densities| {
            let one = Densities { gyro: densities.accelerometer, ..densities };
            right::next_covariance(before, reading, dt, one)
        }),
        whole(&ONE_DENSITY, |readings, dt, densities| {
            let one = Densities { accelerometer: densities.gyro, ..densities };
            right::covariance_of(readings, dt, one)
        }),
        covariance(&TRANSPOSED_PROPAGATION, |before, reading, dt, densities| {
            let (f, _) = right::error_step(reading, dt);
            f.transpose() * before * f
                + right::next_covariance(Matrix6::zeros(), reading, dt, densities)
        }),
        whole(&REVERSED_READINGS, |readings, dt, densities| {
            right::covariance_of(readings.into_iter().rev().collect(), dt, densities)
        }),
        whole(&FIRST_READING_REUSED, |readings, dt, densities| {
            right::covariance_of(vec![readings[0]; readings.len()], dt, densities)
        }),
        exponents(&NOISE_AS_BIAS, |source| {
            let (attitude, velocity, position) = match source {
                Source::Accelerometer => (None, Some(1.0), Some(2.0)),
                Source::Gyroscope => (Some(1.0), Some(2.0), Some(3.0)),
                Source::Both => (Some(1.0), None, None),
            };
            Exponents { attitude, velocity, position }
        }),
        exponents(&VARIANCE_FOR_SIGMA, |source| {
            let Exponents { attitude, velocity, position } = right::predicted_exponents(source);
            let [attitude, velocity, position] =
                [attitude, velocity, position].map(|exponent| Some(2.0 * exponent?));
            Exponents { attitude, velocity, position }
        }),
        exponents(&ONE_EXPONENT_FOR_BOTH, |source| match source {
            Source::Both => right::predicted_exponents(Source::Gyroscope),
            source => right::predicted_exponents(source),
        }),
        fit(&PLAIN_AXES, |durations, sigmas| {
            let exponentials = |list: Vec<f64>| list.into_iter().map(f64::exp).collect();
            right::fitted_exponent(exponentials(durations), exponentials(sigmas))
        }),
        fit(&MIXED_LOGARITHMS, |durations, sigmas| {
            right::fitted_exponent(durations, sigmas) / LN_10
        }),
        fit(&ENDS_ONLY, |durations, sigmas| {
            let ratio = |list: &[f64]| (list[list.len() - 1] / list[0]).ln();
            ratio(&sigmas) / ratio(&durations)
        }),
        fit(&THROUGH_THE_ORIGIN, |durations, sigmas| {
            let logs: Vec<_> =
                durations.iter().zip(&sigmas).map(|(t, s)| (t.ln(), s.ln())).collect();
            let products: f64 = logs.iter().map(|(x, y)| x * y).sum();
            products / logs.iter().map(|(x, _)| x * x).sum::<f64>()
        }),
    ]
}

/// The error after a step, from that before it and an error of its reading.
fn error_after(
    reading: &Reading,
    dt: f64,
    before: &Vector6<f64>,
    noise: &Vector6<f64>,
) -> Vector6<f64> {
    let part = |vector: &Vector6<f64>, at: usize| vector.fixed_rows::<3>(at).into_owned();
    let turn = so3::exp(&(dt * reading.gyro));
    let before_turn = so3::exp(&part(before, 0));
    let gyro = reading.gyro + part(noise, 0);
    let turned = turn.inverse() * before_turn * so3::exp(&(dt * gyro));
    let force = before_turn * (reading.force + part(noise, 3));
    let velocity = turn.inverse() * (part(before, 3) + dt * (force - reading.force));
    let phi = so3::log(&turned);
    Vector6::new(phi.x, phi.y, phi.z, velocity.x, velocity.y, velocity.z)
}

/// F and G from their blocks.
fn blocks(
    reading: &Reading,
    dt: f64,
    attitude: &Matrix3<f64>,
    leak: &Matrix3<f64>,
    velocity: &Matrix3<f64>,
) -> (Matrix6<f64>, Matrix6<f64>) {
    let (mut f, mut g) = (Matrix6::zeros(), Matrix6::zeros());
    f.fixed_view_mut::<3, 3>(0, 0).copy_from(attitude);
    f.fixed_view_mut::<3, 3>(3, 0).copy_from(leak);
    f.fixed_view_mut::<3, 3>(3, 3).copy_from(velocity);
    let right_jacobian = so3::right_jacobian(&(dt * reading.gyro));
    g.fixed_view_mut::<3, 3>(0, 0).copy_from(&(dt * right_jacobian));
    g.fixed_view_mut::<3, 3>(3, 3).copy_from(&(dt * velocity));
    (f, g)
}

/// A step of the covariance in which a reading has a variance of so much for each squared density.
fn next(
    covariance: &Matrix6<f64>,
    reading: &Reading,
    dt: f64,
    densities: &Densities,
    variance: f64,
) -> Matrix6<f64> {
    let (f, g) = right::error_step(*reading, dt);
    let (gyro, force) = (densities.gyro.powi(2), densities.accelerometer.powi(2));
    let of_reading =
        variance * Matrix6::from_diagonal(&Vector6::new(gyro, gyro, gyro, force, force, force));
    f * covariance * f.transpose() + g * of_reading * g.transpose()
}
