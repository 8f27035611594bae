//! Flights whose truth is known: the figure-eight, with a ground truth as good or bad as asked for.

use nalgebra::Vector3;
use vislam::datasets::euroc::GroundTruth;
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, StampedSample};
use vislam::manifold::so3;
use vislam::simulation::Trajectory;

use super::intervals::Flight;
use super::wander::Wander;
use crate::random::Random;

/// Seconds between readings, and readings between states of the ground truth.
pub const STEP: f64 = 0.005;
const PER_STATE: usize = 10;

/// What is wrong with a ground truth.
#[derive(Clone, Copy)]
pub struct Faults {
    pub attitude: Wander,
    pub velocity: Wander,
    /// Gravity in its world less [`GRAVITY`], in m/s².
    pub gravity: Vector3<f64>,
}

pub const BIAS: ImuBias = ImuBias {
    gyro: Vector3::new(-0.002, 0.021, 0.077),
    accelerometer: Vector3::new(-0.02, 0.13, 0.06),
};

/// A flight of so many seconds with noisy readings.
pub fn flight(seconds: f64, seed: u64, faults: Option<&Faults>) -> Flight {
    let mut random = Random::new(seed);
    let gravity = GRAVITY + faults.map_or(Vector3::zeros(), |faults| faults.gravity);
    let (motion, noise) = (Trajectory::figure_eight(), ImuNoise::euroc());
    let count = (seconds / STEP) as usize;
    let nanoseconds = |k: usize| 1_000_000 * 5 * k as i64;
    let samples = (0..count).map(|k| {
        let perfect = motion.at(k as f64 * STEP).sample(&gravity);
        let sample = noise.corrupt(&perfect, &BIAS, STEP, || random.normal(1.0));
        StampedSample { nanoseconds: nanoseconds(k), sample }
    });
    let samples: Vec<StampedSample> = samples.collect();
    let states = count / PER_STATE;
    let mut truth: Vec<GroundTruth> = (0..states)
        .map(|k| GroundTruth {
            nanoseconds: nanoseconds(PER_STATE * k),
            state: motion.at((PER_STATE * k) as f64 * STEP).state,
            bias: BIAS,
        })
        .collect();
    if let Some(faults) = faults {
        spoil(&mut truth, faults, &mut random);
    }
    Flight { samples, truth }
}

/// Positions go wrong as velocities do, so that the two still fit one another.
fn spoil(truth: &mut [GroundTruth], faults: &Faults, random: &mut Random) {
    let step = STEP * PER_STATE as f64;
    let attitude = faults.attitude.drawn(random, step, truth.len());
    let velocity = faults.velocity.drawn(random, step, truth.len());
    let mut position = Vector3::zeros();
    for (k, GroundTruth { state, .. }) in truth.iter_mut().enumerate() {
        // The error is a rotation of the world.
        state.world_from_body = so3::exp(&attitude[k]) * state.world_from_body;
        state.velocity += velocity[k];
        state.position += position;
        if k + 1 < velocity.len() {
            position += 0.5 * step * (velocity[k] + velocity[k + 1]);
        }
    }
}
