//! Deltas by the definition, without the library, and how they move.

use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3, Vector6};
use vislam::inertial::ImuSample;
use vislam::preintegration::{Deltas, Rule, Vector9};

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
        let deltas = Deltas {
            rotation: random.rotation(3.0),
            velocity: random.direction(5.0),
            position: random.direction(5.0),
        };
        Self { deltas, sample: reading(random), dt: random.logarithmic(0.02..0.4) }
    }
}

pub fn reading(random: &mut Random) -> ImuSample {
    let (turn, force) = (random.uniform(0.5..5.0), random.uniform(5.0..20.0));
    ImuSample { gyro: random.direction(turn), accelerometer: random.direction(force) }
}

/// Readings that have nothing to do with one another.
pub fn readings(random: &mut Random, count: usize) -> Vec<ImuSample> {
    (0..count).map(|_| reading(random)).collect()
}

pub fn nothing() -> Deltas {
    let (velocity, position) = (Vector3::zeros(), Vector3::zeros());
    Deltas { rotation: Rotation3::identity(), velocity, position }
}

/// The deltas one reading later; with the midpoint rule the reading is the mean of two.
pub fn stepped(rule: Rule, deltas: &Deltas, sample: &ImuSample, dt: f64) -> Deltas {
    let turned = |time: f64| deltas.rotation * Rotation3::new(time * sample.gyro);
    let along = match rule {
        Rule::Euler => deltas.rotation,
        Rule::Midpoint => turned(0.5 * dt),
    };
    let force = along * sample.accelerometer;
    Deltas {
        rotation: turned(dt),
        velocity: deltas.velocity + dt * force,
        position: deltas.position + dt * deltas.velocity + 0.5 * dt * dt * force,
    }
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

/// The small vector of a small rotation: its odd part, right but for third order.
fn small_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let odd = 0.5 * (rotation - rotation.transpose());
    Vector3::new(odd.m32, odd.m13, odd.m21)
}

/// The errors (φ, v, p) that lead from one to the other, when they are small.
pub fn errors(from: &Deltas, to: &Deltas) -> Vector9 {
    let phi = small_vector((from.rotation.inverse() * to.rotation).matrix());
    let (v, p) = (to.velocity - from.velocity, to.position - from.position);
    Vector9::from_iterator(phi.iter().chain(v.iter()).chain(p.iter()).copied())
}

/// The derivative of deltas by `N` numbers at zero, by central differences.
pub fn slopes<const N: usize>(
    deltas: impl Fn(&SMatrix<f64, N, 1>) -> Deltas,
) -> SMatrix<f64, 9, N> {
    const STEP: f64 = 1e-4;
    let zero = deltas(&SMatrix::zeros());
    let mut columns = SMatrix::<f64, 9, N>::zeros();
    for axis in 0..N {
        let mut at = SMatrix::<f64, N, 1>::zeros();
        at[axis] = STEP;
        let difference = errors(&zero, &deltas(&at)) - errors(&zero, &deltas(&-at));
        columns.set_column(axis, &(difference / (2.0 * STEP)));
    }
    columns
}
