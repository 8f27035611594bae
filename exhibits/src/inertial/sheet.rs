//! What a data sheet says, in the units of the model.

use std::f64::consts::{PI, TAU};

use vislam::inertial::ImuNoise;

use super::averages::averaged;
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Density); 4] = [
        ("taken as it stands", |n| n),
        ("the wrong way", |n| n * 2_f64.sqrt()),
        ("twice the density", |n| 2.0 * n),
        ("by the root of a turn", |n| n / TAU.sqrt()),
    ];
    chapter.equation("inertial-one-sided", inertial_one_sided, two_sided, &mutants);

    let mutants: [(_, Walk); 4] = [
        ("the deviation for the variance", |s, b| 3_f64.sqrt() * b / (2.0 * s)),
        ("without the half", |s, b| 3_f64.sqrt() * b * b / s),
        ("without the root", |s, b| 3.0 * b * b / (2.0 * s)),
        ("the walk that crosses the noise there", |s, b| b * b / s),
    ];
    chapter.equation("inertial-instability", inertial_instability, walk_of, &mutants);
    numbers(chapter);
}

/// Takes a one-sided density and gives that of the model.
type Density = fn(f64) -> f64;

fn two_sided(one_sided: f64) -> f64 {
    one_sided / 2_f64.sqrt()
}

/// Readings in a spectrum, and frequencies at which it is looked at.
const READINGS: usize = 2000;
const FREQUENCIES: usize = 600;

fn inertial_one_sided(formula: Density) -> Comparison {
    let against = "spectra of 2,000 readings over the positive frequencies alone";
    Comparison::relative(against, 0.07).over(20, 14, |random| {
        let (sigma, dt) = (random.logarithmic(1e-4..1e-1), random.logarithmic(2e-3..2e-2));
        let noise = ImuNoise { gyro: sigma, ..ImuNoise::mems() };
        let size = noise.discrete(dt)[(0, 0)].sqrt();
        let readings: Vec<f64> = (0..READINGS).map(|_| random.normal(size)).collect();
        let power = |k: usize| {
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (n, reading) in readings.iter().enumerate() {
                let (s, c) = (TAU * (k * n % READINGS) as f64 / READINGS as f64).sin_cos();
                (cosine, sine) = (cosine + c * reading, sine + s * reading);
            }
            // Of an amplitude's square, half is variance, and bins are 1/(N dt) wide.
            let amplitude = 2.0 * cosine.hypot(sine) / READINGS as f64;
            0.5 * amplitude * amplitude * READINGS as f64 * dt
        };
        let mean = (1..=FREQUENCIES).map(power).sum::<f64>() / FREQUENCIES as f64;
        (formula(mean.sqrt()), sigma)
    })
}

/// Takes the density of the noise and the least Allan deviation, and gives the density of the walk.
type Walk = fn(f64, f64) -> f64;

fn walk_of(sigma: f64, least: f64) -> f64 {
    3_f64.sqrt() * least * least / (2.0 * sigma)
}

fn inertial_instability(formula: Walk) -> Comparison {
    let against = "the walk whose least Allan deviation, of 20,000 windows, is the one given";
    Comparison::relative(against, 1e-4).over(20, 15, |random| {
        let sigma = random.logarithmic(1e-4..1e-2);
        let walk = sigma * random.logarithmic(0.01..1.0);
        let windows = (0..20_000).map(|k| 1e-2 * 1e6_f64.powf(f64::from(k) / 20_000.0));
        let least = windows.map(|tau| averaged(sigma, walk, tau)).fold(f64::MAX, f64::min);
        (formula(sigma, least.sqrt()), walk)
    })
}

/// The sheet of the ADIS16448, as it is printed: °/s/√Hz, °/√h, °/h, mg/√Hz and m/s/√h.
const RATE_DENSITY: f64 = 0.0135;
const ANGLE_WALK: f64 = 0.66;
const IN_RUN_STABILITY: f64 = 14.5;
const FORCE_DENSITY: f64 = 0.23;
const SPEED_WALK: f64 = 0.11;

/// Standard gravity, the g of data sheets.
const STANDARD_GRAVITY: f64 = 9.80665;

fn numbers(chapter: &mut Chapter) {
    chapter.number("sheet_rate_density", RATE_DENSITY, "°/s/√Hz", 4);
    chapter.number("sheet_angle_walk", ANGLE_WALK, "°/√h", 2);
    chapter.number("sheet_stability", IN_RUN_STABILITY, "°/h", 1);
    chapter.number("sheet_force_density", FORCE_DENSITY, "mg/√Hz", 2);
    chapter.number("sheet_speed_walk", SPEED_WALK, "m/s/√h", 2);
    let hour = 3600_f64;
    let degree = PI / 180.0;
    let rate = two_sided(RATE_DENSITY * degree);
    let angle = ANGLE_WALK * degree / hour.sqrt();
    let gyro_walk = walk_of(angle, IN_RUN_STABILITY * degree / hour);
    let force = two_sided(1e-3 * FORCE_DENSITY * STANDARD_GRAVITY);
    let speed = SPEED_WALK / hour.sqrt();
    chapter.number("model_rate_density", 1e3 * rate, "mrad/s/√Hz", 2);
    chapter.number("model_angle_walk", 1e3 * angle, "mrad/s/√Hz", 2);
    chapter.number("model_gyro_walk", 1e6 * gyro_walk, "µrad/s²/√Hz", 0);
    chapter.number("euroc_gyro_walk_density", 1e6 * ImuNoise::euroc().gyro_walk, "µrad/s²/√Hz", 0);
    chapter.number("model_force_density", 1e3 * force, "mm/s²/√Hz", 1);
    chapter.number("model_speed_walk", 1e3 * speed, "mm/s²/√Hz", 1);
    // How far the sheet's spectrum is above its random walk, read in either way.
    chapter.number("sheet_one_sided", 1e2 * (1.0 - rate / angle), "%", 0);
    chapter.number("sheet_two_sided", 1e2 * (2_f64.sqrt() * rate / angle - 1.0), "%", 0);
    chapter.number("root_two_percent", 1e2 * (2_f64.sqrt() - 1.0), "%", 0);
}
