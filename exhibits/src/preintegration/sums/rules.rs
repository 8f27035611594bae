//! The rules of summing, against the continuous equations.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuNoise, ImuSample};
use vislam::preintegration::{Deltas, Rule};
use vislam::simulation::Trajectory;

use super::oracle::{difference, motion, true_deltas};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::{nothing, sizes, summed_by};

/// Takes readings at both ends of all steps, and the step.
type Midpoint = fn(&[ImuSample], f64) -> Deltas;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Midpoint = |samples, dt| summed(Rule::Midpoint, samples, dt);
    let mutants: [(_, Midpoint); 5] = [
        ("force not turned halfway", |samples, dt| by_part(samples, dt, 0.5, 0.0)),
        ("force turned all the way", |samples, dt| by_part(samples, dt, 0.5, 1.0)),
        ("force turned back", |samples, dt| by_part(samples, dt, 0.5, -0.5)),
        ("reading at the beginning", |samples, dt| by_part(samples, dt, 0.0, 0.5)),
        ("reading at the end", |samples, dt| by_part(samples, dt, 1.0, 0.5)),
    ];
    chapter.equation("preint-midpoint", preint_midpoint, formula, &mutants);
}

fn summed(rule: Rule, samples: &[ImuSample], dt: f64) -> Deltas {
    summed_by(rule, samples, std::iter::repeat(dt), &ImuNoise::mems()).deltas
}

/// Sums with the reading a part of the way from the first to the second, and the force turned by a
/// part of the step.
fn by_part(samples: &[ImuSample], dt: f64, reading: f64, turned: f64) -> Deltas {
    let mut deltas = nothing();
    for pair in samples.windows(2) {
        let between = |a: Vector3<f64>, b: Vector3<f64>| a + reading * (b - a);
        let gyro = between(pair[0].gyro, pair[1].gyro);
        let force = between(pair[0].accelerometer, pair[1].accelerometer);
        let along = deltas.rotation * Rotation3::new(turned * dt * gyro);
        let gain = dt * (along * force);
        deltas.position += dt * (deltas.velocity + 0.5 * gain);
        deltas.velocity += gain;
        deltas.rotation *= Rotation3::new(dt * gyro);
    }
    deltas
}

fn preint_midpoint(formula: Midpoint) -> Comparison {
    let against = "two, the order in which errors against the motion's own formula must fall";
    Comparison::absolute(against, 0.1, "").over(40, 51, |random| {
        let motion = motion(random);
        let error = |steps: usize| {
            let dt = 1.0 / steps as f64;
            let found = formula(&motion.samples(&GRAVITY, dt, steps + 1), dt);
            difference(&true_deltas(&motion), &found).norm()
        };
        ((error(400) / error(800)).log2(), 2.0)
    })
}

/// Errors of rotation, velocity and position on the figure-eight after a second in so many steps.
pub fn errors(rule: Rule, steps: usize) -> [f64; 3] {
    let (motion, dt) = (Trajectory::figure_eight(), 1.0 / steps as f64);
    let found = summed(rule, &motion.samples(&GRAVITY, dt, steps + 1), dt);
    sizes(&difference(&true_deltas(&motion), &found))
}
