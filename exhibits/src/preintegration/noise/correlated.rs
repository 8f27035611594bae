//! Noise that remembers, and other things that a density does not say.

use nalgebra::Vector3;
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample};
use vislam::preintegration::Rule;
use vislam::simulation::Trajectory;

use super::growth::{G, sigma};
use super::runs::{DT, SECOND, at_rest, rest, whitened_errors};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::STATES;
use crate::random::Random;

const RUNS: usize = 500;
/// Seconds over which the noise of the worked example forgets.
pub const MEMORY: f64 = 0.02;

/// Takes the number of readings and the correlation of neighbours. Gives the variance of their sum
/// in units of one reading's.
type Sum = fn(usize, f64) -> f64;

fn sum(readings: usize, rho: f64) -> f64 {
    let n = readings as f64;
    n * (1.0 + rho) / (1.0 - rho) - ends(readings, rho)
}

/// What the readings near both ends lack.
fn ends(readings: usize, rho: f64) -> f64 {
    2.0 * rho * (1.0 - rho.powi(readings as i32)) / (1.0 - rho).powi(2)
}

pub fn equations(chapter: &mut Chapter) {
    let mutants: [(_, Sum); 4] = [
        ("as if white", |n, _| n as f64),
        ("ends forgotten", |n, rho| n as f64 * (1.0 + rho) / (1.0 - rho)),
        ("sign of the correlation", |n, rho| sum(n, -rho)),
        ("ends added", |n, rho| sum(n, rho) + 2.0 * ends(n, rho)),
    ];
    chapter.equation("noise-correlated", noise_correlated, sum, &mutants);
}

fn noise_correlated(formula: Sum) -> Comparison {
    let against = "the sum over all pairs of readings";
    Comparison::relative(against, 1e-10).over(STATES, 461, |random| {
        let readings = random.uniform(2.0..80.0) as usize;
        let rho = random.uniform(0.1..0.98);
        let pairs = (0..readings).flat_map(|i| (0..readings).map(move |j| i.abs_diff(j) as i32));
        let oracle: f64 = pairs.map(|apart| rho.powi(apart)).sum();
        (formula(readings, rho), oracle)
    })
}

/// Correlation of neighbouring readings when the noise forgets over `memory` seconds.
pub fn neighbours(memory: f64) -> f64 {
    (-DT / memory).exp()
}

/// How many times larger the attitude's deviation is after so many readings than the density of
/// white noise with the same deviation of a reading says.
pub fn too_sure(readings: usize, memory: f64) -> f64 {
    (sum(readings, neighbours(memory)) / readings as f64).sqrt()
}

/// Six channels of noise with a memory, and the deviation of a reading that white noise has.
struct Remembering {
    rho: f64,
    state: [f64; 6],
}

impl Remembering {
    fn new(memory: f64, random: &mut Random) -> Self {
        Self { rho: neighbours(memory), state: [(); 6].map(|()| random.normal(1.0)) }
    }

    /// The reading with the noise of this moment.
    fn corrupt(&mut self, sample: &ImuSample, noise: &ImuNoise, random: &mut Random) -> ImuSample {
        let fresh = (1.0 - self.rho * self.rho).sqrt();
        for value in &mut self.state {
            *value = self.rho * *value + random.normal(fresh);
        }
        let mut channels = self.state.into_iter();
        let next = || channels.next().unwrap_or(f64::NAN);
        noise.corrupt(sample, &ImuBias::default(), DT, next)
    }
}

/// The mean normalized square of a second's errors, by the covariance for white noise.
fn mean_nees(memory: f64) -> f64 {
    let (noise, mut random) = (ImuNoise::mems(), Random::new(462));
    let noisy = |perfect: &[ImuSample]| {
        let mut remembering = Remembering::new(memory, &mut random);
        perfect.iter().map(|sample| remembering.corrupt(sample, &noise, &mut random)).collect()
    };
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, SECOND + 1);
    let errors = whitened_errors(Rule::Euler, samples, RUNS, noisy);
    errors.map(|error| error.norm_squared()).sum::<f64>() / RUNS as f64
}

/// Root mean square angle of the attitude's error after each of these numbers of readings, in
/// units of what the densities say.
pub fn attitude_runs(memory: f64, readings: &[usize], runs: usize) -> Vec<f64> {
    let (noise, mut random) = (ImuNoise::mems(), Random::new(463));
    let last = readings.iter().copied().max().unwrap_or(0);
    let mut squares = vec![0.0; readings.len()];
    for _ in 0..runs {
        let mut remembering = Remembering::new(memory, &mut random);
        // At rest the small turns add up.
        let (mut turned, mut next) = (Vector3::zeros(), 0);
        for index in 0..last {
            turned += DT * remembering.corrupt(&rest(), &noise, &mut random).gyro;
            if readings.get(next) == Some(&(index + 1)) {
                squares[next] += turned.norm_squared() / 3.0 / runs as f64;
                next += 1;
            }
        }
    }
    let predicted = |count: &usize| noise.gyro * (*count as f64 * DT).sqrt();
    readings.iter().zip(squares).map(|(n, square)| square.sqrt() / predicted(n)).collect()
}

pub fn numbers(chapter: &mut Chapter) {
    let rho = neighbours(MEMORY);
    chapter.number("noise_memory_ms", 1e3 * MEMORY, "ms", 0);
    chapter.number("noise_neighbours", rho, "", 2);
    chapter.number("noise_too_sure", ((1.0 + rho) / (1.0 - rho)).sqrt(), "", 1);
    chapter.number("noise_nees_runs", RUNS as f64, "", 0);
    chapter.number("noise_nees_remembering", mean_nees(MEMORY), "", 0);
    other_errors(chapter);
}

/// What else goes wrong in a second, beside the deviations.
fn other_errors(chapter: &mut Chapter) {
    let mems = ImuNoise::mems();
    let scale = 0.005;
    chapter.number("noise_scale_percent", 100.0 * scale, "%", 1);
    chapter.number("noise_scale_v", 1e2 * scale * G, "cm/s", 1);
    let up = 1e2 * sigma(&at_rest(&mems, DT, SECOND), 5);
    chapter.number("noise_scale_sigmas", 1e2 * scale * G / up, "", 1);
    let gyro = 3.0_f64.sqrt() * mems.gyro / mems.gyro_walk;
    chapter.number("noise_walk_gyro_s", gyro, "s", 0);
    let force = 3.0_f64.sqrt() * mems.accelerometer / mems.accelerometer_walk;
    chapter.number("noise_walk_accelerometer_s", force, "s", 1);
}
