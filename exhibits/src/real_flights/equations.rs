//! The numbered equations of the section.

use std::f64::consts::{FRAC_PI_2, PI};
use std::iter::repeat;

use nalgebra::{Matrix3, SVector, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise};
use vislam::manifold::so3;
use vislam::preintegration::{Deltas, Preintegrated, Rule, imu_residual};
use vislam::simulation::Trajectory;

use super::budget::{FromTruth, from_truth};
use super::wander::Wander;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::summed_by;

/// Rotation into the first body frame and duration give what a wrong gravity leaves in velocity
/// and position.
type LeftByGravity = fn(&Matrix3<f64>, &Vector3<f64>, f64) -> [Vector3<f64>; 2];
type Spread = fn(sigma: f64, tau: f64, t: f64) -> f64;
type Enters = fn(&Deltas) -> FromTruth;

pub fn equations(chapter: &mut Chapter) {
    let gravity: &[(&str, LeftByGravity)] = &[
        ("world frame", |_, off, t| left_by_gravity(&Matrix3::identity(), off, t)),
        ("body to world", |body, off, t| left_by_gravity(&body.transpose(), off, t)),
        ("without the half", |body, off, t| [t * body * off, t * t * body * off]),
        ("opposite sign", |body, off, t| left_by_gravity(body, &-off, t)),
    ];
    chapter.equation("flight-gravity", flight_gravity, left_by_gravity, gravity);
    let wander: &[(&str, Spread)] = &[
        ("forgets by an exponential alone", |s, tau, t| 6.0 * s * s * (1.0 - (-t / tau).exp())),
        ("one end only", |s, tau, t| spread(s, tau, t) / 2.0),
        ("one axis only", |s, tau, t| spread(s, tau, t) / 3.0),
        ("rate for time", |s, tau, t| spread(s, 1.0 / tau, t)),
        ("opposite sign in the bracket", |s, tau, t| {
            6.0 * s * s * (1.0 - (1.0 - t / tau) * (-t / tau).exp())
        }),
    ];
    chapter.equation("flight-wander", flight_wander, spread, wander);
    let enters: &[(&str, Enters)] = &[
        ("opposite sign of the first attitude", |deltas| scaled(deltas, &[0], -1.0)),
        ("rotation not transposed", |deltas| {
            from_truth(&Deltas { rotation: deltas.rotation.inverse(), ..*deltas })
        }),
        ("no leak into velocity", |deltas| scaled(deltas, &[3], 0.0)),
        ("leak with the opposite sign", |deltas| scaled(deltas, &[3, 6], -1.0)),
        ("no leak into position", |deltas| scaled(deltas, &[6], 0.0)),
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

/// With blocks in the first column, which begin in these rows, times a factor.
fn scaled(deltas: &Deltas, rows: &[usize], factor: f64) -> FromTruth {
    let mut matrix = from_truth(deltas);
    for row in rows {
        matrix.fixed_view_mut::<3, 3>(*row, 0).scale_mut(factor);
    }
    matrix
}

/// The sums of perfect readings on the figure-eight, in so many steps of `dt` seconds between these times.
fn perfect(
    gravity: &Vector3<f64>,
    steps: u32,
    dt: f64,
    time: impl Fn(f64) -> f64,
) -> Preintegrated {
    let motion = Trajectory::figure_eight();
    let read = |k: u32| motion.at(time(f64::from(k))).sample(gravity);
    let samples: Vec<_> = (0..=steps).map(read).collect();
    summed_by(Rule::Midpoint, &samples, repeat(dt), &ImuNoise::euroc())
}

/// Perfect readings of a flight in a gravity that is not the one assumed.
fn flight_gravity(formula: LeftByGravity) -> Comparison {
    Comparison::relative("a simulated flight in another gravity", 1e-4).over(30, 11, |random| {
        let off = random.direction(0.3);
        let (start, t) = (random.uniform(0.0..20.0), random.uniform(0.3..1.5));
        let dt = t / 2000.0;
        let sums = perfect(&(GRAVITY + off), 2000, dt, |k| start + k * dt);
        let motion = Trajectory::figure_eight();
        let (first, last) = (motion.at(start).state, motion.at(start + t).state);
        let residual = imu_residual(&sums, &first, &last, &GRAVITY, &ImuBias::default());
        let found = formula(first.world_from_body.inverse().matrix(), &off, t);
        (found, residual.fixed_rows::<6>(3).into_owned())
    })
}

/// The power that a critically damped filter passes of white noise, summed over frequencies: those
/// are the rate times the tangent of an angle.
fn flight_wander(formula: Spread) -> Comparison {
    const NODES: u32 = 40_000;
    let against = "the sum over the spectrum of a damped filter";
    Comparison::relative(against, 1e-3).over(40, 12, |random| {
        let sigma = random.logarithmic(1e-4..1.0);
        let tau = random.logarithmic(0.2..5.0);
        let t = tau * random.logarithmic(0.1..8.0);
        let width = FRAC_PI_2 / f64::from(NODES);
        let power = (0..NODES).map(|k| {
            let angle = (f64::from(k) + 0.5) * width;
            angle.cos().powi(2) * (1.0 - (angle.tan() * t / tau).cos())
        });
        let of_axis = 2.0 * sigma * sigma * 4.0 / PI * width * power.sum::<f64>();
        (formula(sigma, tau, t), 3.0 * of_axis)
    })
}

/// Central differences of the residual by errors of the states.
fn flight_truth(formula: Enters) -> Comparison {
    const STEP: f64 = 1e-4;
    Comparison::relative("differences of the residual", 1e-6).over(25, 13, |random| {
        let (start, t) = (random.uniform(0.0..20.0), random.uniform(0.2..1.0));
        let sums = perfect(&GRAVITY, 400, t / 400.0, |k| start + t * k / 400.0);
        let (first, bias) = (Trajectory::figure_eight().at(start).state, ImuBias::default());
        // The end that fits the readings, so that the residual is zero.
        let last = sums.predict(&first, &GRAVITY, &bias);
        let residual = |errors: SVector<f64, 12>| {
            let part = |at: usize| errors.fixed_rows::<3>(at).into_owned();
            let (mut from, mut to) = (first, last);
            from.world_from_body = so3::retract(&first.world_from_body, &part(0));
            let seen_last = sums.deltas.rotation.inverse() * part(3);
            to.world_from_body = so3::retract(&last.world_from_body, &seen_last);
            // Errors of velocity and position are seen from the first body frame, where they differ.
            to.velocity += first.world_from_body * part(6);
            to.position += first.world_from_body * part(9);
            imu_residual(&sums, &from, &to, &GRAVITY, &bias)
        };
        let slopes = std::array::from_fn::<_, 12, _>(|column| {
            let error = SVector::ith(column, STEP);
            (residual(error) - residual(-error)) / (2.0 * STEP)
        });
        (formula(&sums.deltas), FromTruth::from_columns(&slopes))
    })
}
