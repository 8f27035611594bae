//! Where a sensor ends up that nobody corrects.

use nalgebra::Vector3;
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::simulation::Trajectory;

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Drift); 5] = [
        ("without the half", |b, t| t * t * b.accelerometer + leaning(b, t)),
        ("sign of the lean", |b, t| 0.5 * t * t * b.accelerometer - leaning(b, t)),
        ("gravity sensed as a bias", |b, t| {
            0.5 * t * t * (b.accelerometer + GRAVITY.norm() * b.gyro)
        }),
        ("lean that stays", |b, t| 0.5 * t * t * b.accelerometer + 3.0 * leaning(b, t) / t),
        ("lean dropped", |b, t| 0.5 * t * t * b.accelerometer),
    ];
    chapter.equation("inertial-drift-bias", inertial_drift_bias, drift, &mutants);

    let mutants: [(_, DriftNoise); 4] = [
        ("noise that averages out", |n, t| {
            variance(n, t) - own(n, t) + n.accelerometer.powi(2) * t
        }),
        ("noise for a bias", |n, t| (0.5 * t * t * n.accelerometer).powi(2)),
        ("lean dropped", own),
        ("gravity dropped", |n, t| own(n, t) + n.gyro.powi(2) * t.powi(5) / 20.0),
    ];
    chapter.equation("inertial-drift-noise", inertial_drift_noise, variance, &mutants);
    numbers(chapter);
}

/// Takes the bias nobody took off, and a time.
type Drift = fn(&ImuBias, f64) -> Vector3<f64>;

/// How far a resting level sensor is believed to have gone.
fn drift(bias: &ImuBias, t: f64) -> Vector3<f64> {
    0.5 * t * t * bias.accelerometer + leaning(bias, t)
}

fn leaning(bias: &ImuBias, t: f64) -> Vector3<f64> {
    GRAVITY.norm() * t.powi(3) / 6.0 * bias.gyro.cross(&Vector3::z())
}

const RESTING: ImuSample =
    ImuSample { gyro: Vector3::new(0.0, 0.0, 0.0), accelerometer: Vector3::new(0.0, 0.0, 9.81) };

fn inertial_drift_bias(formula: Drift) -> Comparison {
    let against = "a resting sensor with a small bias, propagated in 500 steps";
    Comparison::relative(against, 1e-3).over(200, 40, |random| {
        let t = random.uniform(1.0..30.0);
        let bias =
            ImuBias { gyro: random.direction(1e-5), accelerometer: random.direction(3e-5 * t) };
        let read = RESTING.biased(&bias);
        let mut state = NavState::origin();
        for _ in 0..500 {
            state = state.propagate_midpoint(&read, &read, &GRAVITY, t / 500.0);
        }
        (formula(&bias, t), state.position)
    })
}

/// Takes densities and a time; the variance along a level axis.
type DriftNoise = fn(&ImuNoise, f64) -> f64;

fn variance(noise: &ImuNoise, t: f64) -> f64 {
    let leaning = (GRAVITY.norm() * noise.gyro).powi(2) * t.powi(5) / 20.0;
    own(noise, t) + leaning
}

/// What the accelerometer's own noise contributes.
fn own(noise: &ImuNoise, t: f64) -> f64 {
    noise.accelerometer.powi(2) * t.powi(3) / 3.0
}

fn inertial_drift_noise(formula: DriftNoise) -> Comparison {
    let against = "the position after an error of each of 200 readings, squared and summed";
    Comparison::relative(against, 1e-3).over(20, 41, |random| {
        let t = random.uniform(0.5..30.0);
        let accelerometer = random.logarithmic(1e-3..1e-1);
        // Chosen so that neither sensor hides the other.
        let gyro = random.uniform(0.3..3.0) * accelerometer / (9.81 * t);
        let noise = ImuNoise { gyro, accelerometer, ..ImuNoise::euroc() };
        let dt = t / 200.0;
        let reading = noise.discrete(dt);
        // An error at the y axis of the gyroscope or the x axis of the accelerometer leads along x.
        let sum: f64 = (0..200)
            .map(|k| {
                let along_x = |axis: usize| moved_by(axis, k, dt).powi(2);
                reading[(1, 1)] * along_x(1) + reading[(3, 3)] * along_x(3)
            })
            .sum();
        (formula(&noise, t), sum)
    })
}

/// How far along x an error of one in one of 200 readings moves a resting sensor.
fn moved_by(axis: usize, wrong: usize, dt: f64) -> f64 {
    let size = 1e-6;
    let mut error = nalgebra::Vector6::zeros();
    error[axis] = size;
    let mut state = NavState::origin();
    for k in 0..200 {
        let read = if k == wrong { RESTING.biased(&ImuBias::from_vector(&error)) } else { RESTING };
        state = state.propagate_midpoint(&read, &read, &GRAVITY, dt);
    }
    state.position.x / size
}

/// What makes a sensor drift in the figure: its name, the noise of the readings, and sizes of the
/// biases of gyroscope and accelerometer.
#[derive(Clone, Copy)]
pub struct Source {
    pub name: &'static str,
    noise: ImuNoise,
    biases: [f64; 2],
}

pub fn sources() -> [Source; 4] {
    let ImuNoise { gyro, accelerometer, .. } = ImuNoise::euroc();
    let source = |name, [gyro, accelerometer]: [f64; 2], biases| {
        let noise = ImuNoise { gyro, accelerometer, gyro_walk: 0.0, accelerometer_walk: 0.0 };
        Source { name, noise, biases }
    };
    [
        source("accelerometer noise", [0.0, accelerometer], [0.0, 0.0]),
        source("gyroscope noise", [gyro, 0.0], [0.0, 0.0]),
        source("accelerometer bias", [0.0, 0.0], [0.0, ACCELEROMETER_BIAS]),
        source("gyroscope bias", [0.0, 0.0], [GYRO_BIAS, 0.0]),
    ]
}

/// Sizes of the biases nobody took off, in rad/s and m/s².
const GYRO_BIAS: f64 = 1e-3;
const ACCELEROMETER_BIAS: f64 = 0.02;

/// Times in the figure, in seconds.
pub const TIMES: [f64; 7] = [1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 60.0];

/// Runs for each source.
pub const RUNS: usize = 40;

const STEP: f64 = 0.01;

/// How far a resting sensor drifts in the level plane, by the formulas, in metres. A source has either
/// noise or a bias.
pub fn expected(source: &Source, t: f64) -> f64 {
    let [gyro, accelerometer] = source.biases;
    let biases = 0.5 * accelerometer * t * t + GRAVITY.norm() * gyro * t.powi(3) / 6.0;
    2_f64.sqrt() * variance(&source.noise, t).sqrt() + biases
}

/// Level distance from the truth at [`TIMES`], root mean square over [`RUNS`] runs.
pub fn drifted(source: &Source, motion: &Trajectory) -> [f64; TIMES.len()] {
    let mut random = Random::new(42);
    let steps = (TIMES[TIMES.len() - 1] / STEP).round() as usize;
    let samples = motion.samples(&GRAVITY, STEP, steps + 1);
    let mut squares = [0.0; TIMES.len()];
    for _ in 0..RUNS {
        let read = spoiled(&samples, source, &mut random);
        let mut state = motion.at(0.0).state;
        for (k, pair) in read.windows(2).enumerate() {
            state = state.propagate_midpoint(&pair[0], &pair[1], &GRAVITY, STEP);
            let t = (k + 1) as f64 * STEP;
            if let Some(at) = TIMES.iter().position(|time| (time - t).abs() < 0.5 * STEP) {
                let error = state.position - motion.at(t).state.position;
                squares[at] += error.xy().norm_squared() / RUNS as f64;
            }
        }
    }
    squares.map(f64::sqrt)
}

/// Readings with the noise, and with the biases along a level axis of the body.
fn spoiled(samples: &[ImuSample], source: &Source, random: &mut Random) -> Vec<ImuSample> {
    let angle = random.uniform(0.0..std::f64::consts::TAU);
    let along = Vector3::new(angle.cos(), angle.sin(), 0.0);
    let [gyro, accelerometer] = source.biases.map(|size| size * along);
    let bias = ImuBias { gyro, accelerometer };
    let spoil = |sample| source.noise.corrupt(sample, &bias, STEP, || random.normal(1.0));
    samples.iter().map(spoil).collect()
}

fn numbers(chapter: &mut Chapter) {
    chapter.number("drift_gyro_bias", 1e3 * GYRO_BIAS, "mrad/s", 0);
    chapter.number("drift_gyro_bias_deg", GYRO_BIAS.to_degrees(), "°/s", 2);
    chapter.number("drift_acc_bias", 100.0 * ACCELEROMETER_BIAS, "cm/s²", 0);
    chapter.number("drift_ab_hand", ACCELEROMETER_BIAS, "m/s²", 2);
    let blink = sources().iter().map(|of| expected(of, 0.1).powi(2)).sum::<f64>().sqrt();
    chapter.number("drift_blink_mm", 1e3 * blink, "mm", 1);
    chapter.number("drift_runs", RUNS as f64, "", 0);
    let equal = 3.0 * ACCELEROMETER_BIAS / (GRAVITY.norm() * GYRO_BIAS);
    chapter.number("drift_equal", equal, "s", 1);
    let names = [
        ["drift_an_10", "drift_an_60"],
        ["drift_gn_10", "drift_gn_60"],
        ["drift_ab_10", "drift_ab_60"],
        ["drift_gb_10", "drift_gb_60"],
    ];
    for ([ten, sixty], source) in names.into_iter().zip(sources()) {
        chapter.number(ten, expected(&source, 10.0), "m", 2);
        chapter.number(sixty, expected(&source, 60.0), "m", 1);
    }
}
