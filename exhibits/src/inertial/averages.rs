//! What averaging does to noise and to a bias that walks.

use nalgebra::{Vector3, Vector6};
use vislam::inertial::{ImuBias, ImuNoise, ImuSample};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Variance); 5] = [
        ("noise that does not fall", |s, w, tau| s * s + w * w * tau / 3.0),
        ("a walk that does not rise", |s, w, tau| s * s / tau + w * w / 3.0),
        ("walk of the whole window", |s, w, tau| s * s / tau + w * w * tau),
        ("both means' noise", |s, w, tau| 2.0 * s * s / tau + w * w * tau / 3.0),
        ("walk dropped", |s, _, tau| s * s / tau),
    ];
    chapter.equation("inertial-allan-lines", inertial_allan_lines, averaged, &mutants);

    let mutants: [(_, Variance); 4] = [
        ("noise alone", |s, _, t| s * s / t),
        ("no noise", |_, w, t| w * w * t / 3.0),
        ("walk of the whole time", |s, w, t| s * s / t + w * w * t),
        ("a walk that averages out", |s, w, t| s * s / t + w * w / (3.0 * t)),
    ];
    chapter.equation("inertial-bias-average", inertial_bias_average, averaged, &mutants);
    numbers(chapter);
}

/// The variance of both equations, for a density of white noise, one of a walk, and a time.
pub fn averaged(sigma: f64, walk: f64, time: f64) -> f64 {
    sigma * sigma / time + walk * walk * time / 3.0
}

type Variance = fn(f64, f64, f64) -> f64;

fn inertial_allan_lines(formula: Variance) -> Comparison {
    let against = "half the square of the weight of every single increment, summed over 4,000";
    // Two neighbouring means, the second one less the first.
    let weights: Vec<f64> = (0..4000).map(|k| if k < 2000 { -1.0 } else { 1.0 } / 2000.0).collect();
    compared(against, 11, formula, |sigma, walk, tau| {
        0.5 * variance(&weights, 0.0, sigma, walk, tau / 2000.0)
    })
}

fn inertial_bias_average(formula: Variance) -> Comparison {
    let against = "the square of the weight of every single increment, summed over 2,000";
    compared(against, 12, formula, |sigma, walk, time| {
        variance(&[1.0 / 2000.0; 2000], -1.0, sigma, walk, time / 2000.0)
    })
}

fn compared(
    against: &'static str,
    seed: u64,
    formula: Variance,
    oracle: impl Fn(f64, f64, f64) -> f64,
) -> Comparison {
    Comparison::relative(against, 1e-5).over(100, seed, |random| {
        let sigma = random.logarithmic(1e-4..1e-2);
        let walk = sigma * random.logarithmic(0.01..1.0);
        let time = 3_f64.sqrt() * sigma / walk * random.logarithmic(0.2..5.0);
        (formula(sigma, walk, time), oracle(sigma, walk, time))
    })
}

/// Variance of a sum of readings with these weights, to which the bias at the end is added with a
/// weight of its own. The bias takes its steps in the middle of readings.
fn variance(weights: &[f64], end: f64, sigma: f64, walk: f64, dt: f64) -> f64 {
    let white: f64 = weights.iter().map(|w| w * w * sigma * sigma / dt).sum();
    // An increment of the walk is in every later reading, in half of its own, and in the end.
    let mut later = end;
    let mut walked = 0.0;
    for weight in weights.iter().rev() {
        walked += (later + 0.5 * weight).powi(2) * walk * walk * dt;
        later += weight;
    }
    white + walked
}

fn numbers(chapter: &mut Chapter) {
    let best = |sigma: f64, walk: f64| 3_f64.sqrt() * sigma / walk;
    let (poor, good) = (ImuNoise::mems(), ImuNoise::euroc());
    chapter.number("best_mems_gyro", best(poor.gyro, poor.gyro_walk), "s", 0);
    chapter.number("best_euroc_gyro", best(good.gyro, good.gyro_walk), "s", 0);
    chapter.number("best_mems_acc", best(poor.accelerometer, poor.accelerometer_walk), "s", 1);
    chapter.number("best_euroc_acc", best(good.accelerometer, good.accelerometer_walk), "s", 1);
    let least = |sigma: f64, walk: f64| averaged(sigma, walk, best(sigma, walk)).sqrt();
    let gyro = least(poor.gyro, poor.gyro_walk);
    chapter.number("least_mems_gyro", gyro.to_degrees(), "°/s", 3);
    let fading = (poor.gyro * poor.gyro_walk).sqrt();
    chapter.number("fading_mems_gyro", fading.to_degrees(), "°/s", 3);
    let long = 600.0;
    chapter.number("long_average", long / 60.0, "min", 0);
    let told = poor.gyro / f64::sqrt(long);
    chapter.number("long_told", told.to_degrees(), "°/s", 3);
    let true_deviation = averaged(poor.gyro, poor.gyro_walk, long).sqrt();
    chapter.number("long_true", true_deviation.to_degrees(), "°/s", 3);
    chapter.number("long_factor", true_deviation / told, "", 0);
    chapter.number("averaging_runs", RUNS as f64, "", 0);
    chapter.number("staying_deg", STAYING.to_degrees(), "°/s", 2);
    chapter.number("allan_hours", HOURS, "h", 0);
}

/// Resting sensors in the figure of averages.
pub const RUNS: usize = 500;
/// A bias that stays, in rad/s.
pub const STAYING: f64 = 2e-3;
/// Readings in a second of the figure of averages.
const AVERAGED_RATE: f64 = 20.0;

/// What the mean of a resting gyroscope's readings meets: its name, a bias that stays and is taken
/// for noise, in rad/s, and the density of one that walks, of which the mean should tell the end.
pub type Case = (&'static str, f64, f64);

pub fn cases() -> [Case; 3] {
    let walk = ImuNoise::mems().gyro_walk;
    [("no bias", 0.0, 0.0), ("a bias stays", STAYING, 0.0), ("a bias walks", 0.0, walk)]
}

/// Errors of means over these times, in seconds: root mean square over runs, in rad/s.
pub fn errors_of_means((_, staying, walk): Case, times: &[f64]) -> Vec<f64> {
    let (noise, dt) = (ImuNoise::mems(), 1.0 / AVERAGED_RATE);
    let mut random = Random::new(13);
    let mut squares = vec![0.0; times.len()];
    for _ in 0..RUNS {
        let (mut bias, mut sum, mut count, mut next) = (staying, 0.0, 0.0, 0);
        while next < times.len() {
            bias += random.normal(walk * dt.sqrt());
            sum += bias + random.normal(noise.gyro / dt.sqrt());
            count += 1.0;
            if count * dt >= times[next] - 1e-9 {
                squares[next] += (sum / count - (bias - staying)).powi(2) / RUNS as f64;
                next += 1;
            }
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

/// The same by the formulas.
pub fn expected_error((_, staying, walk): Case, time: f64) -> f64 {
    averaged(ImuNoise::mems().gyro, walk, time).sqrt().hypot(staying)
}

/// Length of the resting recording behind the figure of Allan deviations.
const HOURS: f64 = 2.0;
/// Readings in a second of it.
const RATE: f64 = 50.0;

/// Allan deviations of a simulated resting sensor, gyroscope and accelerometer, for windows of
/// these numbers of readings. The six axes count as three and three.
pub fn allan_deviations(noise: &ImuNoise, windows: &[usize], seed: u64) -> Vec<[f64; 2]> {
    let mut random = Random::new(seed);
    let dt = 1.0 / RATE;
    let resting = ImuSample { gyro: Vector3::zeros(), accelerometer: Vector3::zeros() };
    let mut bias = ImuBias::default();
    let readings = (0..(3600.0 * HOURS * RATE) as usize).map(|_| {
        bias = noise.walk(&bias, dt, || random.normal(1.0));
        noise.corrupt(&resting, &bias, dt, || random.normal(1.0))
    });
    let sums = sums(readings);
    windows.iter().map(|&window| allan_deviation(&sums, window)).collect()
}

/// Sums of no reading, of the first one and so on, gyroscope first.
pub fn sums(readings: impl Iterator<Item = ImuSample>) -> Vec<Vector6<f64>> {
    let mut sums = vec![Vector6::zeros()];
    for (k, ImuSample { gyro, accelerometer }) in readings.enumerate() {
        sums.push(sums[k] + ImuBias { gyro, accelerometer }.vector());
    }
    sums
}

/// From sums of the readings: half the mean squared difference of neighbouring means.
pub fn allan_deviation(sums: &[Vector6<f64>], window: usize) -> [f64; 2] {
    let mean = |k: usize| (sums[k + window] - sums[k]) / window as f64;
    let starts = (0..sums.len() - 2 * window).step_by(window.div_ceil(4));
    let mut squares = [0.0; 2];
    let count = starts.len() as f64;
    for k in starts {
        let difference = mean(k + window) - mean(k);
        for (sensor, square) in squares.iter_mut().enumerate() {
            *square += difference.fixed_rows::<3>(3 * sensor).norm_squared() / (6.0 * count);
        }
    }
    squares.map(f64::sqrt)
}

/// Seconds of a window of so many readings.
pub fn seconds(window: usize) -> f64 {
    window as f64 / RATE
}
