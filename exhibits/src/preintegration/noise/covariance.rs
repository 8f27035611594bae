//! The recursion of the covariance, and the noise that one reading brings.

use nalgebra::{Matrix6, Vector6};
use vislam::inertial::{ImuBias, ImuNoise};
use vislam::preintegration::{
    ErrorDynamics, Matrix9, Matrix9x6, Preintegrator, Rule, error_dynamics,
};

use super::blocks::correlation;
use super::growth::{G, exchanged};
use super::oracle::{densities, noisy, readings, slopes, summed};
use super::runs::{DT, at_rest, rest};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::nothing;

const STATES: usize = 100;

/// Takes the covariance before a step, its dynamics, the noise densities and its length.
type Recursion = fn(&Matrix9, &ErrorDynamics, &ImuNoise, f64) -> Matrix9;

/// One step, given the covariance of a reading.
fn step(before: &Matrix9, step: &ErrorDynamics, reading: &Matrix6<f64>) -> Matrix9 {
    let ErrorDynamics { from_errors: a, from_reading: b } = step;
    a * before * a.transpose() + b * reading * b.transpose()
}

pub fn equations(chapter: &mut Chapter) {
    let formula: Recursion = |before, of, noise, dt| step(before, of, &noise.discrete(dt));
    let mutants: [(_, Recursion); 5] = [
        ("transposed", |before, of, noise, dt| {
            let transposed = ErrorDynamics { from_errors: of.from_errors.transpose(), ..*of };
            step(before, &transposed, &noise.discrete(dt))
        }),
        ("density taken for the deviation of a reading", |before, of, noise, dt| {
            step(before, of, &(dt * noise.discrete(dt)))
        }),
        ("deviation of a reading taken for the density", |before, of, noise, dt| {
            step(before, of, &(noise.discrete(dt) / dt))
        }),
        ("no new noise", |before, of, noise, dt| step(before, of, &(0.0 * noise.discrete(dt)))),
        ("sensors exchanged", |before, of, noise, dt| {
            step(before, of, &exchanged(noise).discrete(dt))
        }),
    ];
    chapter.equation("covariance-recursion", covariance_recursion, formula, &mutants);
}

fn covariance_recursion(formula: Recursion) -> Comparison {
    let against = "the derivatives of the last deltas by every single reading, by differences";
    Comparison::relative(against, 1e-6).over(STATES, 411, |random| {
        let samples = readings(random, 12);
        let dt = random.logarithmic(0.005..0.1);
        let noise = densities(random, 1e-3..1e-1, 1e-3..1e-1);
        let (mut found, mut deltas) = (Matrix9::zeros(), nothing());
        let mut oracle = Matrix9::zeros();
        for (k, sample) in samples.iter().enumerate() {
            let of = error_dynamics(Rule::Euler, &deltas.rotation, sample, dt);
            found = formula(&found, &of, &noise, dt);
            let before = deltas;
            deltas = summed(&deltas, &[*sample], dt);
            let by_reading: Matrix9x6 = slopes(|n| {
                let start = summed(&before, &[noisy(sample, n)], dt);
                summed(&start, &samples[k + 1..], dt)
            });
            let variances = [noise.gyro, noise.accelerometer].map(|d| d * d / dt);
            let reading = Vector6::from_fn(|i, _| variances[i / 3]);
            oracle += by_reading * Matrix6::from_diagonal(&reading) * by_reading.transpose();
        }
        (found, oracle)
    })
}

/// Deviation of the attitude after a second at rest, in mrad, for whoever takes densities for the
/// deviations of readings that come in steps of `dt` seconds.
fn attitude_by_mistake(dt: f64) -> f64 {
    let steps = (1.0 / dt).round() as usize;
    // A density of σ √dt makes readings with a deviation of σ.
    let mistaken = ImuNoise { gyro: ImuNoise::mems().gyro * dt.sqrt(), ..ImuNoise::mems() };
    1e3 * at_rest(&mistaken, dt, steps).sigmas()[0]
}

pub fn numbers(chapter: &mut Chapter) {
    let mems = ImuNoise::mems();
    chapter.number("noise_rate", 1.0 / DT, "Hz", 0);
    chapter.number("noise_twice_rate", 2.0 / DT, "Hz", 0);
    chapter.number("noise_tilt_leak", 1e-3 * G * 1e3, "mm/s²", 2);
    let reading = |dt| mems.discrete(dt)[(0, 0)].sqrt();
    chapter.number("noise_gyro_reading", 1e3 * reading(DT), "mrad/s", 1);
    chapter.number("noise_gyro_reading_twice", 1e3 * reading(0.5 * DT), "mrad/s", 1);
    chapter.number("noise_trap_factor", 1.0 / DT.sqrt(), "", 1);
    chapter.number("noise_trap_half_rate", attitude_by_mistake(2.0 * DT), "mrad", 2);
    chapter.number("noise_trap_rate", attitude_by_mistake(DT), "mrad", 2);
    chapter.number("noise_trap_twice_rate", attitude_by_mistake(0.5 * DT), "mrad", 2);
    chapter.number("noise_half_rate", 0.5 / DT, "Hz", 0);
    let halved = at_rest(&mems, 0.5 * DT, (2.0 / DT) as usize).sigmas();
    let once = at_rest(&mems, DT, (1.0 / DT) as usize).sigmas();
    chapter.number("covariance_rate_change", 100.0 * (halved[2] / once[2] - 1.0), "%", 2);
    one_step(chapter);
}

/// After one step and after two, whether there is a whitener.
fn one_step(chapter: &mut Chapter) {
    let mut integrator =
        Preintegrator::new(&ImuBias::default(), &ImuNoise::mems()).expect("the sensor is one");
    let [first, second] = [(); 2].map(|()| {
        integrator.integrate(&rest(), DT).expect("the reading is finite");
        let sums = integrator.finish().expect("there is a step");
        assert_eq!(sums.sqrt_information().is_ok(), sums.steps > 1, "a whitener");
        // How many directions vary, after each error was measured by its own deviation.
        let eigenvalues = correlation(&sums.covariance).symmetric_eigenvalues();
        eigenvalues.iter().filter(|value| **value > 1e-9).count()
    });
    chapter.number("covariance_first_rank", first as f64, "", 0);
    chapter.number("covariance_second_rank", second as f64, "", 0);
}
