//! Noise without a size of its own: densities, and what they come to after a second.

use vislam::inertial::ImuNoise;

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Variances = |sigma, dt, t| {
        let reading = ImuNoise { gyro: sigma, ..ImuNoise::mems() }.discrete(dt)[(0, 0)];
        [reading, (t / dt) * dt * dt * reading]
    };
    let mutants: [(_, Variances); 4] = [
        ("times the step", |sigma, dt, t| [sigma * sigma * dt, sigma * sigma * t]),
        ("the density for a deviation", |sigma, dt, t| [sigma * sigma, sigma * sigma * t * dt]),
        ("deviations added", |sigma, dt, t| [sigma * sigma / dt, (sigma * t).powi(2) / dt]),
        ("step forgotten in the sum", |s, dt, t| [s * s / dt, (t / dt) * s * s / dt]),
    ];
    chapter.equation("inertial-density", inertial_density, formula, &mutants);
    numbers(chapter);
}

/// Takes a density, a step and a time, and gives the variances of a reading and of the sum.
type Variances = fn(f64, f64, f64) -> [f64; 2];

/// Tosses of a coin in a step of the walk behind the readings.
const TOSSES: usize = 4;
const WALKS: usize = 10_000;

fn inertial_density(formula: Variances) -> Comparison {
    let against = "10,000 walks of a coin for each state, read off at the end of every step";
    let mut random = Random::new(10);
    let states = (0..20).flat_map(|_| {
        let sigma = random.logarithmic(1e-4..1e-1);
        let dt = random.logarithmic(2e-3..2e-2);
        let steps = random.uniform(2.0..12.0) as usize;
        let toss = sigma * (dt / TOSSES as f64).sqrt();
        let mut variances = [0.0; 2];
        for _ in 0..WALKS {
            let (mut walk, mut reading) = (0.0, 0.0);
            for _ in 0..steps {
                let before = walk;
                for _ in 0..TOSSES {
                    walk += if random.uniform(0.0..1.0) < 0.5 { toss } else { -toss };
                }
                reading = (walk - before) / dt;
            }
            variances[0] += reading * reading / WALKS as f64;
            variances[1] += walk * walk / WALKS as f64;
        }
        formula(sigma, dt, steps as f64 * dt).into_iter().zip(variances)
    });
    Comparison::relative(against, 0.07).each(states, |both| both)
}

/// Seconds between two readings of the sensors in the text.
pub const STEP: f64 = 0.005;

fn numbers(chapter: &mut Chapter) {
    chapter.number("rate_hz", 1.0 / STEP, "Hz", 0);
    let deviations = |noise: &ImuNoise| noise.discrete(STEP).diagonal().map(f64::sqrt);
    let (poor, good) = (ImuNoise::mems(), ImuNoise::euroc());
    chapter.number("mems_gyro_density", 1e3 * poor.gyro, "mrad/s/√Hz", 1);
    chapter.number("euroc_gyro_density", 1e3 * good.gyro, "mrad/s/√Hz", 2);
    chapter.number("mems_acc_density", 1e3 * poor.accelerometer, "mm/s²/√Hz", 0);
    chapter.number("euroc_acc_density", 1e3 * good.accelerometer, "mm/s²/√Hz", 0);
    chapter.number("mems_gyro_reading", deviations(&poor)[0].to_degrees(), "°/s", 1);
    chapter.number("euroc_gyro_reading", deviations(&good)[0].to_degrees(), "°/s", 2);
    chapter.number("mems_acc_reading", 100.0 * deviations(&poor)[3], "cm/s²", 0);
    chapter.number("euroc_acc_reading", 100.0 * deviations(&good)[3], "cm/s²", 1);
    // After one second, an angle and a speed have the number of their density.
    chapter.number("mems_angle", poor.gyro.to_degrees(), "°", 2);
    chapter.number("euroc_angle", good.gyro.to_degrees(), "°", 3);
    chapter.number("mems_angle_hour", (60.0 * poor.gyro).to_degrees(), "°", 0);
    chapter.number("euroc_angle_hour", (60.0 * good.gyro).to_degrees(), "°", 2);
    let walked = good.gyro_walk * (3600_f64.powi(3) / 3.0).sqrt();
    chapter.number("euroc_walk_hour", walked.to_degrees(), "°", 0);
    chapter.number("mems_speed", 100.0 * poor.accelerometer, "cm/s", 1);
    chapter.number("euroc_speed", 100.0 * good.accelerometer, "cm/s", 1);
    let walks = |noise: &ImuNoise| noise.bias_walk(1.0).diagonal().map(f64::sqrt);
    chapter.number("mems_gyro_walk", walks(&poor)[0].to_degrees(), "°/s", 3);
    chapter.number("euroc_gyro_walk", walks(&good)[0].to_degrees(), "°/s", 4);
    chapter.number("mems_acc_walk", 100.0 * walks(&poor)[3], "cm/s²", 1);
    chapter.number("euroc_acc_walk", 100.0 * walks(&good)[3], "cm/s²", 1);
}
