//! Preintegrates intervals of a real flight and compares them with its ground truth.
//!
//! ```text
//! cargo run --release -p vislam --example euroc -- IMU.csv GROUNDTRUTH.csv
//! ```
//!
//! The files are those of the EuRoC data sets. The states and biases at the beginning of an
//! interval and the state at its end are the ground truth's. Intervals follow one another
//! without overlap. Printed are the root mean square over all intervals of the residual's parts
//! (each the length of a vector of three), the same for its predicted standard deviations, and
//! the mean of the normalized error squared, which would be 9 if nothing erred but the readings
//! by their densities. Then comes the direction of gravity as the velocities of the ground truth
//! show it: where it does not point along the vertical, the world of the ground truth is not level.
//! Its size is left out, since it is as good as the ground truth's accelerometer bias. The last
//! lines are the time of one reading in windows of 200, with covariance and derivatives by the
//! biases.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use nalgebra::Vector3;
use vislam::datasets::euroc::{GroundTruth, read_ground_truth, read_imu};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, StampedSample, WindowError, between};
use vislam::preintegration::{
    LONGEST_STEP, Preintegrated, Preintegrator, Rule, imu_residual, preintegrate_stamped,
};

const USAGE: &str = "usage: euroc IMU.csv GROUNDTRUTH.csv";

/// Lengths of the intervals, in seconds.
const LENGTHS: [f64; 4] = [0.1, 0.5, 1.0, 2.0];

/// Readings in a window whose time is taken.
const WINDOW: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [imu, ground_truth] = arguments.as_slice() else {
        return Err(USAGE.into());
    };
    let samples = read_imu(&read(imu)?).map_err(|error| format!("{imu}: {error}"))?;
    let truth = read_ground_truth(&read(ground_truth)?)
        .map_err(|error| format!("{ground_truth}: {error}"))?;
    println!("{} readings, {} states", samples.len(), truth.len());
    println!(
        "                       attitude, mrad     velocity, cm/s     position, cm       error²"
    );
    println!(
        "rule      s  intervals  error  predicted   error  predicted   error  predicted   of 9"
    );
    for rule in [Rule::Euler, Rule::Midpoint] {
        for seconds in LENGTHS {
            report(&samples, &truth, rule, seconds)?;
        }
    }
    let gravity = gravity(&samples, &truth)?;
    let tilt = 1e3 * gravity.xy().norm().atan2(-gravity.z);
    println!("gravity: {tilt:.1} mrad from the vertical");
    for rule in [Rule::Euler, Rule::Midpoint] {
        println!("{}: {:.1} ns per sample", name(rule), time(&samples, rule)?);
    }
    Ok(())
}

fn read(file: &str) -> Result<String, String> {
    std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))
}

fn name(rule: Rule) -> &'static str {
    match rule {
        Rule::Euler => "Euler",
        Rule::Midpoint => "midpoint",
    }
}

/// One line: all intervals of one length by one rule.
fn report(
    samples: &[StampedSample],
    truth: &[GroundTruth],
    rule: Rule,
    seconds: f64,
) -> Result<(), Box<dyn Error>> {
    let (mut squares, mut predicted, mut nees) = ([0.0; 3], [0.0; 3], 0.0);
    let summed = summed(samples, truth, rule, seconds)?;
    for (first, sums, last) in &summed {
        let error = imu_residual(sums, &first.state, &last.state, &GRAVITY, &first.bias);
        nees += (sums.sqrt_information()? * error).norm_squared();
        for (part, sigma) in sums.sigmas().into_iter().enumerate() {
            squares[part] += error.fixed_rows::<3>(3 * part).norm_squared();
            predicted[part] += 3.0 * sigma * sigma;
        }
    }
    let count = summed.len();
    let root = |sum: f64| (sum / count as f64).sqrt();
    print!("{:8} {seconds:3}  {count:9}", name(rule));
    for (part, scale) in [1e3, 1e2, 1e2].into_iter().enumerate() {
        print!("  {:6.2}  {:8.2} ", scale * root(squares[part]), scale * root(predicted[part]));
    }
    println!("  {:.1}", nees / count as f64);
    Ok(())
}

/// An interval: the states at both ends, and the readings between them summed up.
type Interval<'a> = (&'a GroundTruth, Preintegrated, &'a GroundTruth);

/// All intervals of a length.
fn summed<'a>(
    samples: &[StampedSample],
    truth: &'a [GroundTruth],
    rule: Rule,
    seconds: f64,
) -> Result<Vec<Interval<'a>>, Box<dyn Error>> {
    let mut all = Vec::new();
    for (first, last) in intervals(truth, seconds) {
        let window = match between(samples, first.nanoseconds, last.nanoseconds) {
            Err(WindowError::NotCovered { .. }) => continue,
            window => window?,
        };
        let noise = ImuNoise::euroc();
        let sums = preintegrate_stamped(&window, rule, LONGEST_STEP, &first.bias, &noise)?;
        all.push((first, sums, last));
    }
    if all.is_empty() {
        let sentence = format!(
            "no two states of the ground truth {seconds} s apart have readings between them; give files of \
             one flight"
        );
        return Err(sentence.into());
    }
    Ok(all)
}

/// Gravity as the ground truth shows it: [`GRAVITY`] and what velocities gain beyond it, on average
/// over intervals of a second.
fn gravity(
    samples: &[StampedSample],
    truth: &[GroundTruth],
) -> Result<Vector3<f64>, Box<dyn Error>> {
    let mut missing = Vector3::zeros();
    let summed = summed(samples, truth, Rule::Midpoint, 1.0)?;
    for (first, sums, last) in &summed {
        let error = imu_residual(sums, &first.state, &last.state, &GRAVITY, &first.bias);
        let velocity = error.fixed_rows::<3>(3).into_owned();
        missing += first.state.world_from_body * velocity / sums.duration;
    }
    Ok(GRAVITY + missing / summed.len() as f64)
}

/// Pairs of states this far apart, to a millisecond, one after the other.
fn intervals(truth: &[GroundTruth], seconds: f64) -> Vec<(&GroundTruth, &GroundTruth)> {
    let length = (1e9 * seconds) as i64;
    let slack = 1_000_000;
    let (mut pairs, mut at) = (Vec::new(), 0);
    while let Some(first) = truth.get(at) {
        let end = first.nanoseconds + length;
        let next = truth.partition_point(|state| state.nanoseconds < end - slack);
        match truth.get(next) {
            Some(last) if last.nanoseconds <= end + slack => {
                pairs.push((first, last));
                at = next;
            }
            _ => at += 1,
        }
    }
    pairs
}

/// Nanoseconds for a reading: the median of fifteen runs over the whole flight.
fn time(samples: &[StampedSample], rule: Rule) -> Result<f64, Box<dyn Error>> {
    let windows = samples.len().saturating_sub(1) / WINDOW;
    if windows == 0 {
        return Err(format!(
            "{} readings are too few to time; give more than {WINDOW}",
            samples.len()
        )
        .into());
    }
    let mut times = Vec::new();
    for _ in 0..15 {
        let start = Instant::now();
        for window in 0..windows {
            let mut integrator = Preintegrator::new(&ImuBias::default(), &ImuNoise::euroc())?;
            for pair in samples[WINDOW * window..].windows(2).take(WINDOW) {
                match rule {
                    Rule::Euler => integrator.integrate(&pair[0].sample, 0.005)?,
                    Rule::Midpoint => {
                        integrator.integrate_midpoint(&pair[0].sample, &pair[1].sample, 0.005)?;
                    }
                }
            }
            black_box(integrator.finish()?);
        }
        times.push(1e9 * start.elapsed().as_secs_f64() / (windows * WINDOW) as f64);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}
