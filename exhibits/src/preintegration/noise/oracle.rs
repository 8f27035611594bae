//! Deltas by the definition, without the library, and how they move.

use std::ops::Range;

use nalgebra::{Rotation3, SMatrix, Vector6};
use vislam::inertial::{ImuNoise, ImuSample};
use vislam::preintegration::{Deltas, Rule, Vector9};

use crate::manifold::oracle::small_vector;
use crate::preintegration::oracle::{stack, stepped};
use crate::random::Random;

/// A turned body with a reading, and how long the reading holds.
#[derive(Clone, Copy)]
pub struct Instant {
    pub deltas: Deltas,
    pub sample: ImuSample,
    pub dt: f64,
}

impl Instant {
    /// With steps long enough for the right Jacobian to differ from the identity.
    pub fn random(random: &mut Random) -> Self {
        let (rotation, velocity) = (random.rotation(3.0), random.direction(5.0));
        let deltas = Deltas { rotation, velocity, position: random.direction(5.0) };
        Self { deltas, sample: reading(random), dt: random.logarithmic(0.02..0.4) }
    }
}

pub fn reading(random: &mut Random) -> ImuSample {
    let (turn, force) = (random.uniform(0.5..5.0), random.uniform(5.0..20.0));
    ImuSample { gyro: random.direction(turn), accelerometer: random.direction(force) }
}

/// White noise with densities from these ranges.
pub fn densities(random: &mut Random, gyro: Range<f64>, accelerometer: Range<f64>) -> ImuNoise {
    let (gyro, accelerometer) = (random.logarithmic(gyro), random.logarithmic(accelerometer));
    ImuNoise { gyro, accelerometer, ..ImuNoise::mems() }
}

/// Readings that have nothing to do with one another.
pub fn readings(random: &mut Random, count: usize) -> Vec<ImuSample> {
    (0..count).map(|_| reading(random)).collect()
}

/// The deltas of readings by the Euler rule.
pub fn summed(from: &Deltas, samples: &[ImuSample], dt: f64) -> Deltas {
    samples.iter().fold(*from, |deltas, sample| stepped(Rule::Euler, &deltas, sample, dt))
}

/// Deltas with the errors (φ, v, p), the rotation's on the right.
pub fn wrong(deltas: &Deltas, errors: &Vector9) -> Deltas {
    Deltas {
        rotation: deltas.rotation * Rotation3::new(errors.fixed_rows::<3>(0).clone_owned()),
        velocity: deltas.velocity + errors.fixed_rows::<3>(3),
        position: deltas.position + errors.fixed_rows::<3>(6),
    }
}

/// A reading with noise, gyroscope first.
pub fn noisy(sample: &ImuSample, noise: &Vector6<f64>) -> ImuSample {
    ImuSample {
        gyro: sample.gyro + noise.fixed_rows::<3>(0),
        accelerometer: sample.accelerometer + noise.fixed_rows::<3>(3),
    }
}

/// The errors (φ, v, p) that lead from one to the other, when they are small.
fn errors(from: &Deltas, to: &Deltas) -> Vector9 {
    let phi = small_vector((from.rotation.inverse() * to.rotation).matrix());
    stack(&phi, &(to.velocity - from.velocity), &(to.position - from.position))
}

/// The derivative of deltas by `N` numbers at zero, by central differences.
pub fn slopes<const N: usize>(
    deltas: impl Fn(&SMatrix<f64, N, 1>) -> Deltas,
) -> SMatrix<f64, 9, N> {
    const STEP: f64 = 1e-4;
    let zero = deltas(&SMatrix::zeros());
    let columns = std::array::from_fn::<_, N, _>(|axis| {
        let at = SMatrix::from_fn(|k, _| if k == axis { STEP } else { 0.0 });
        (errors(&zero, &deltas(&at)) - errors(&zero, &deltas(&-at))) / (2.0 * STEP)
    });
    SMatrix::from_columns(&columns)
}
