//! The numbered equations of the section.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, SMatrix, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::preintegration::{Deltas, Preintegrator, imu_residual};
use vislam::simulation::Trajectory;

use super::budget::{FromTruth, from_truth};
use super::wander::{Wander, correlation};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Rotation into the first body frame and duration give what a wrong gravity leaves in velocity
/// and position.
type LeftByGravity = fn(&Matrix3<f64>, &Vector3<f64>, f64) -> [Vector3<f64>; 2];
type Spread = fn(sigma: f64, tau: f64, t: f64) -> f64;
type Enters = fn(&Deltas) -> FromTruth;

pub fn equations(chapter: &mut Chapter) {
    let gravity: &[(&str, LeftByGravity)] = &[
        ("world frame", |_, off, t| [t * off, 0.5 * t * t * off]),
        ("body to world", |body, off, t| {
            let seen = body.transpose() * off;
            [t * seen, 0.5 * t * t * seen]
        }),
        ("without the half", |body, off, t| [t * body * off, t * t * body * off]),
        ("opposite sign", |body, off, t| [-t * body * off, -0.5 * t * t * body * off]),
    ];
    chapter.equation("flight-gravity", flight_gravity, left_by_gravity, gravity);
    let wander: &[(&str, Spread)] = &[
        ("forgets by an exponential alone", |sigma, tau, t| {
            6.0 * sigma * sigma * (1.0 - (-t / tau).exp())
        }),
        ("one end only", |sigma, tau, t| 3.0 * sigma * sigma * (1.0 - correlation(tau, t))),
        ("one axis only", |sigma, tau, t| 2.0 * sigma * sigma * (1.0 - correlation(tau, t))),
        ("rate for time", |sigma, tau, t| 6.0 * sigma * sigma * (1.0 - correlation(1.0 / tau, t))),
        ("opposite sign in the bracket", |sigma, tau, t| {
            6.0 * sigma * sigma * (1.0 - (1.0 - t / tau) * (-t / tau).exp())
        }),
    ];
    chapter.equation("flight-wander", flight_wander, spread, wander);
    let enters: &[(&str, Enters)] = &[
        ("opposite sign of the first attitude", |deltas| {
            let mut matrix = from_truth(deltas);
            matrix.fixed_view_mut::<3, 3>(0, 0).neg_mut();
            matrix
        }),
        ("rotation not transposed", |deltas| {
            let mut matrix = from_truth(deltas);
            matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&-deltas.rotation.matrix());
            matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(deltas.rotation.matrix());
            matrix
        }),
        ("no leak into velocity", |deltas| {
            let mut matrix = from_truth(deltas);
            matrix.fixed_view_mut::<3, 3>(3, 0).fill(0.0);
            matrix
        }),
        ("leak with the opposite sign", |deltas| {
            let mut matrix = from_truth(deltas);
            matrix.fixed_view_mut::<6, 3>(3, 0).neg_mut();
            matrix
        }),
        ("no leak into position", |deltas| {
            let mut matrix = from_truth(deltas);
            matrix.fixed_view_mut::<3, 3>(6, 0).fill(0.0);
            matrix
        }),
    ];
    chapter.equation("flight-truth", flight_truth, from_truth, enters);
}

fn left_by_gravity(
    body_from_world: &Matrix3<f64>,
    off: &Vector3<f64>,
    t: f64,
) -> [Vector3<f64>; 2] {
    let seen = body_from_world * off;
    [t * seen, 0.5 * t * t * seen]
}

fn spread(sigma: f64, tau: f64, t: f64) -> f64 {
    Wander { sigma, tau }.spread(t)
}

/// Perfect readings of a flight in a gravity that is not the one assumed.
fn flight_gravity(formula: LeftByGravity) -> Comparison {
    let mut comparison = Comparison::relative("a simulated flight in another gravity", 1e-4);
    let mut random = Random::new(11);
    for _ in 0..30 {
        let off = random.direction(0.3);
        let (start, t) = (random.uniform(0.0..20.0), random.uniform(0.3..1.5));
        let motion = Trajectory::figure_eight();
        let steps = 2000;
        let dt = t / f64::from(steps);
        let read = |k: i32| motion.at(start + f64::from(k) * dt).sample(&(GRAVITY + off));
        let bias = ImuBias::default();
        let mut sums = Preintegrator::new(&bias, &ImuNoise::euroc()).expect("a sensor");
        for k in 0..steps {
            sums.integrate_midpoint(&read(k), &read(k + 1), dt).expect("good readings");
        }
        let sums = sums.finish().expect("readings");
        let (first, last) = (motion.at(start).state, motion.at(start + t).state);
        let residual = imu_residual(&sums, &first, &last, &GRAVITY, &bias);
        let [velocity, position] = formula(first.world_from_body.inverse().matrix(), &off, t);
        let said = [velocity.as_slice(), position.as_slice()].concat();
        comparison.add(&said, &residual.as_slice()[3..9]);
    }
    comparison
}

/// The power that a critically damped filter passes of white noise, summed over frequencies: those
/// are the rate times the tangent of an angle.
fn flight_wander(formula: Spread) -> Comparison {
    let mut comparison = Comparison::relative("the sum over the spectrum of a damped filter", 1e-3);
    let mut random = Random::new(12);
    for _ in 0..40 {
        let sigma = random.logarithmic(1e-4..1.0);
        let tau = random.logarithmic(0.2..5.0);
        let t = tau * random.logarithmic(0.1..8.0);
        let nodes = 40_000;
        let width = FRAC_PI_2 / f64::from(nodes);
        let power = (0..nodes).map(|k| {
            let angle = (f64::from(k) + 0.5) * width;
            angle.cos().powi(2) * (1.0 - (angle.tan() * t / tau).cos())
        });
        let of_axis = 2.0 * sigma * sigma * 4.0 / PI * width * power.sum::<f64>();
        comparison.add(&[formula(sigma, tau, t)], &[3.0 * of_axis]);
    }
    comparison
}

/// Central differences of the residual by errors of the states.
fn flight_truth(formula: Enters) -> Comparison {
    let mut comparison = Comparison::relative("differences of the residual", 1e-6);
    let mut random = Random::new(13);
    let motion = Trajectory::figure_eight();
    for _ in 0..25 {
        let (start, t) = (random.uniform(0.0..20.0), random.uniform(0.2..1.0));
        let samples: Vec<_> = (0..=400)
            .map(|k| motion.at(start + t * f64::from(k) / 400.0).sample(&GRAVITY))
            .collect();
        let bias = ImuBias::default();
        let mut sums = Preintegrator::new(&bias, &ImuNoise::euroc()).expect("a sensor");
        for pair in samples.windows(2) {
            sums.integrate_midpoint(&pair[0], &pair[1], t / 400.0).expect("good readings");
        }
        let sums = sums.finish().expect("readings");
        let first = motion.at(start).state;
        // The end that fits the readings, so that the residual is zero.
        let last = sums.predict(&first, &GRAVITY, &bias);
        // Errors of velocity and position are seen from the first body frame, where they differ.
        let turn = *first.world_from_body.matrix();
        let residual = |step: &[f64; 12]| {
            let part = |at: usize| Vector3::new(step[at], step[at + 1], step[at + 2]);
            let (velocity, position) = (turn * part(6), turn * part(9));
            let mut moved = last.retract(&[0.0; 9]);
            let seen_last = sums.deltas.rotation.inverse() * part(3);
            moved.world_from_body = so3::retract(&last.world_from_body, &seen_last);
            moved.velocity += velocity;
            moved.position += position;
            let mut from = first;
            from.world_from_body = so3::retract(&first.world_from_body, &part(0));
            imu_residual(&sums, &from, &moved, &GRAVITY, &bias)
        };
        let size = 1e-4;
        let mut slopes = SMatrix::<f64, 9, 12>::zeros();
        for column in 0..12 {
            let (mut up, mut down) = ([0.0; 12], [0.0; 12]);
            (up[column], down[column]) = (size, -size);
            slopes.set_column(column, &((residual(&up) - residual(&down)) / (2.0 * size)));
        }
        comparison.add(formula(&sums.deltas).as_slice(), slopes.as_slice());
    }
    comparison
}
