//! Sums by either rule, and deltas as vectors of nine.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{ImuBias, ImuNoise, ImuSample};
use vislam::manifold::so3;
use vislam::preintegration::{Deltas, Preintegrated, Preintegrator, Rule, Vector9};

/// Random states at which an equation is compared, unless its oracle is costly.
pub const STATES: usize = 500;

/// The library's sums of readings at the ends of steps of these lengths.
pub fn summed_by(
    rule: Rule,
    samples: &[ImuSample],
    steps: impl IntoIterator<Item = f64>,
    noise: &ImuNoise,
) -> Preintegrated {
    let mut sums = Preintegrator::new(&ImuBias::default(), noise).expect("the noise of a sensor");
    for (pair, dt) in samples.windows(2).zip(steps) {
        match rule {
            Rule::Euler => sums.integrate(&pair[0], dt),
            Rule::Midpoint => sums.integrate_midpoint(&pair[0], &pair[1], dt),
        }
        .expect("the readings are finite");
    }
    sums.finish().expect("there is a step")
}

/// The deltas of no reading.
pub fn nothing() -> Deltas {
    let (velocity, position) = (Vector3::zeros(), Vector3::zeros());
    Deltas { rotation: Rotation3::identity(), velocity, position }
}

/// The deltas one reading later, without the library; with the midpoint rule the reading is the mean of two.
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

/// The errors (φ, v, p) that lead from one to the other, by the library's logarithm.
pub fn errors(from: &Deltas, to: &Deltas) -> Vector9 {
    let phi = so3::local(&from.rotation, &to.rotation);
    stack(&phi, &(to.velocity - from.velocity), &(to.position - from.position))
}

/// Three vectors as one, in the order (φ, v, p).
pub fn stack(phi: &Vector3<f64>, velocity: &Vector3<f64>, position: &Vector3<f64>) -> Vector9 {
    Vector9::from_iterator(phi.iter().chain(velocity).chain(position).copied())
}

/// The three vectors that stand in one.
pub fn parts(errors: &Vector9) -> [Vector3<f64>; 3] {
    [0, 3, 6].map(|at| errors.fixed_rows::<3>(at).into())
}

/// Their lengths.
pub fn sizes(errors: &Vector9) -> [f64; 3] {
    parts(errors).map(|part| part.norm())
}
