//! Many flights with the same motion and other noise.

use std::sync::LazyLock;

use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample};
use vislam::preintegration::{Matrix9, Preintegrated, Rule, Vector9, preintegrate};
use vislam::simulation::Trajectory;

use crate::chapter::Chapter;
use crate::preintegration::oracle::{errors, summed_by};
use crate::random::Random;

/// Seconds between two readings.
pub const DT: f64 = 0.005;
/// Readings in a second.
pub const SECOND: usize = 200;
pub const RUNS: usize = 2000;
/// Between these lie the eigenvalues of the scatter of whitened errors.
pub const LIMITS: [f64; 2] = [0.83, 1.18];
/// Experiments with numbers that are normal for certain.
const EXPERIMENTS: usize = 400;

/// What a perfect sensor reads at rest.
pub fn rest() -> ImuSample {
    Trajectory::hover().at(0.0).sample(&GRAVITY)
}

/// The sums of so many steps at rest.
pub fn at_rest(noise: &ImuNoise, dt: f64, steps: usize) -> Preintegrated {
    of_readings(&vec![rest(); steps], dt, noise)
}

/// The sums of readings by the Euler rule.
pub fn of_readings(samples: &[ImuSample], dt: f64, noise: &ImuNoise) -> Preintegrated {
    preintegrate(samples, dt, &ImuBias::default(), noise).expect("the readings are finite")
}

/// The sums of readings at the ends of all steps, by either rule.
pub fn by_rule(rule: Rule, samples: &[ImuSample], noise: &ImuNoise) -> Preintegrated {
    summed_by(rule, samples, std::iter::repeat(DT), noise)
}

/// The readings with white noise.
pub fn noisy(samples: &[ImuSample], noise: &ImuNoise, random: &mut Random) -> Vec<ImuSample> {
    let bias = ImuBias::default();
    let corrupt = |sample| noise.corrupt(sample, &bias, DT, || random.normal(1.0));
    samples.iter().map(corrupt).collect()
}

/// Its name, the rule with which it is summed, and the motion.
type Case = (&'static str, Rule, fn() -> Trajectory);

pub const CASES: [Case; 3] = [
    ("at rest", Rule::Euler, Trajectory::hover),
    ("figure-eight", Rule::Euler, Trajectory::figure_eight),
    ("figure-eight (midpoint)", Rule::Midpoint, Trajectory::figure_eight),
];

/// Eigenvalues of the scatter of a second's whitened errors, in rising order, and the mean of their
/// squared lengths.
fn whitened(rule: Rule, motion: &Trajectory, seed: u64) -> (Vec<f64>, f64) {
    let (noise, mut random) = (ImuNoise::mems(), Random::new(seed));
    let mut scatter = Matrix9::zeros();
    let samples = motion.samples(&GRAVITY, DT, SECOND + 1);
    let noisy = |perfect: &[ImuSample]| noisy(perfect, &noise, &mut random);
    for error in whitened_errors(rule, samples, RUNS, noisy) {
        scatter += error * error.transpose() / RUNS as f64;
    }
    (sorted_eigenvalues(&scatter), scatter.trace())
}

/// Errors of perfect readings' sums by their covariance, one for each run with the noise it makes.
pub fn whitened_errors(
    rule: Rule,
    samples: Vec<ImuSample>,
    runs: usize,
    mut noisy: impl FnMut(&[ImuSample]) -> Vec<ImuSample>,
) -> impl Iterator<Item = Vector9> {
    let noise = ImuNoise::mems();
    let clean = by_rule(rule, &samples, &noise);
    let whiten = clean.sqrt_information().expect("after many steps everything varies");
    let run = move |_| by_rule(rule, &noisy(&samples), &noise).deltas;
    (0..runs).map(run).map(move |deltas| whiten * errors(&clean.deltas, &deltas))
}

/// Errors after a second at rest, one for each run.
pub fn errors_at_rest(runs: usize) -> Vec<Vector9> {
    let (noise, samples) = (ImuNoise::mems(), [rest(); SECOND]);
    let clean = of_readings(&samples, DT, &noise);
    let mut random = Random::new(423);
    let run = |_| {
        let readings = noisy(&samples, &noise, &mut random);
        errors(&clean.deltas, &of_readings(&readings, DT, &noise).deltas)
    };
    (0..runs).map(run).collect()
}

fn sorted_eigenvalues(matrix: &Matrix9) -> Vec<f64> {
    let mut eigenvalues: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    eigenvalues.sort_by(f64::total_cmp);
    eigenvalues
}

/// What [`whitened`] gives for each of [`CASES`].
pub static WHITENED: LazyLock<[(Vec<f64>, f64); 3]> = LazyLock::new(|| {
    let mut seed = 423;
    CASES.map(|(_, rule, motion)| {
        seed += 1;
        whitened(rule, &motion(), seed)
    })
});

/// The eigenvalues that nine independent normal numbers show in as many runs: for each, in rising
/// order, the whole sorted sample of experiments.
pub static NORMAL: LazyLock<[Vec<f64>; 9]> = LazyLock::new(|| {
    let mut random = Random::new(422);
    let mut by_rank: [Vec<f64>; 9] = Default::default();
    for _ in 0..EXPERIMENTS {
        let mut scatter = Matrix9::zeros();
        for _ in 0..RUNS {
            let draw = Vector9::from_fn(|_, _| random.normal(1.0));
            scatter += draw * draw.transpose() / RUNS as f64;
        }
        for (rank, value) in by_rank.iter_mut().zip(sorted_eigenvalues(&scatter)) {
            rank.push(value);
        }
    }
    by_rank.map(|mut rank| {
        rank.sort_by(f64::total_cmp);
        rank
    })
});

/// Where the eigenvalues of the scatter of so many draws of nine normal numbers end, when both
/// numbers are large.
pub fn edges() -> [f64; 2] {
    let root = (9.0 / RUNS as f64).sqrt();
    [(1.0 - root).powi(2), (1.0 + root).powi(2)]
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("covariance_runs", RUNS as f64, "", 0);
    chapter.number("covariance_limit_low", LIMITS[0], "", 2);
    chapter.number("covariance_limit_high", LIMITS[1], "", 2);
    let [low, high] = edges();
    chapter.number("covariance_edge_low", low, "", 2);
    chapter.number("covariance_edge_high", high, "", 2);
    let all = || WHITENED.iter().flat_map(|(eigenvalues, _)| eigenvalues);
    chapter.number("covariance_least", all().fold(f64::INFINITY, |a, b| a.min(*b)), "", 2);
    chapter.number("covariance_most", all().fold(0.0_f64, |a, b| a.max(*b)), "", 2);
    chapter.number("covariance_nees_rest", WHITENED[0].1, "", 2);
    chapter.number("covariance_nees_flight", WHITENED[1].1, "", 2);
    chapter.number("covariance_experiments", EXPERIMENTS as f64, "", 0);
    chapter.number("covariance_normal_least", NORMAL[0][0], "", 2);
    chapter.number("covariance_normal_most", NORMAL[8][EXPERIMENTS - 1], "", 2);
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, SECOND);
    let swept: f64 = samples.iter().map(|sample| DT * sample.gyro.norm()).sum();
    chapter.number("covariance_flight_swept_deg", swept.to_degrees(), "°", 0);
}
