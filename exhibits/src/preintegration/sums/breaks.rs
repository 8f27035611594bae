//! What breaks, in numbers.

use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::preintegration::{Preintegrated, Preintegrator, Rule, imu_residual};
use vislam::simulation::Trajectory;

use super::oracle::{deltas_of_states, difference, summed, true_deltas};
use crate::chapter::Chapter;
use crate::preintegration::oracle::sizes;

const DT: f64 = 0.005;
const STEPS: usize = 200;

pub fn numbers(chapter: &mut Chapter) {
    order_of_updates(chapter);
    gravity(chapter);
    clipping(chapter);
    gaps(chapter);
}

/// The state `DT` seconds on, with the velocity moved before the position.
fn velocity_first(state: &NavState, sample: &ImuSample) -> NavState {
    let acceleration = GRAVITY + state.world_from_body * sample.accelerometer;
    let velocity = state.velocity + DT * acceleration;
    NavState {
        position: state.position + DT * velocity + 0.5 * DT * DT * acceleration,
        velocity,
        world_from_body: state.world_from_body * Rotation3::new(DT * sample.gyro),
    }
}

fn order_of_updates(chapter: &mut Chapter) {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, STEPS);
    let delta_from = |first: &NavState| {
        let second = samples.iter().fold(*first, |state, s| velocity_first(&state, s));
        deltas_of_states(first, &second, &GRAVITY, DT * STEPS as f64).position
    };
    let right = summed(&samples, DT, &ImuBias::default()).deltas;
    let upright = Trajectory::figure_eight().at(0.0).state;
    let lying = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let lying = NavState { world_from_body: lying * upright.world_from_body, ..upright };
    let apart = (delta_from(&lying) - delta_from(&upright)).norm();
    chapter.number("order_apart_mm", 1e3 * apart, "mm", 0);

    // In the deltas alone, at rest: what the sums of the library do not do.
    let rest = vec![Trajectory::hover().at(0.0).sample(&GRAVITY); STEPS];
    let sums = summed(&rest, DT, &ImuBias::default());
    let off = DT * sums.deltas.velocity.norm();
    chapter.number("order_rest_mm", 1e3 * off, "mm", 0);
    chapter.number("order_rest_sigmas", off / vertical(&sums, 8), "", 1);

    // The rotation before the force: the reading turned by itself.
    let (mut rotation, mut velocity) = (Rotation3::identity(), Vector3::zeros());
    for sample in &samples {
        rotation *= Rotation3::new(DT * sample.gyro);
        velocity += DT * (rotation * sample.accelerometer);
    }
    chapter.number("order_turned_mm", 1e3 * (velocity - right.velocity).norm(), "mm/s", 0);
}

fn gravity(chapter: &mut Chapter) {
    let (origin, rest) = (NavState::origin(), Trajectory::hover().at(0.0).sample(&GRAVITY));
    let sums = summed(&vec![rest; STEPS], DT, &ImuBias::default());
    let residual = |gravity: &Vector3<f64>| {
        imu_residual(&sums, &origin, &origin, gravity, &ImuBias::default())
    };
    let forgotten = residual(&Vector3::zeros());
    chapter.number("forgotten_velocity", forgotten[5].abs(), "m/s", 2);
    chapter.number("forgotten_position", forgotten[8].abs(), "m", 1);
    let sigmas = forgotten[5].abs() / vertical(&sums, 5);
    chapter.number("forgotten_sigmas", sigmas, "", 0);
    // Normal gravity is 9.780 m/s² at the equator and 9.824 m/s² at the polar circle.
    let elsewhere = residual(&(GRAVITY + (9.824 - 9.780) * Vector3::z()));
    chapter.number("elsewhere_sigmas", elsewhere[5].abs() / vertical(&sums, 5), "", 1);
}

/// The standard deviation of one coordinate.
fn vertical(sums: &Preintegrated, coordinate: usize) -> f64 {
    sums.covariance[(coordinate, coordinate)].sqrt()
}

fn clipping(chapter: &mut Chapter) {
    let limit = 0.6;
    let perfect = Trajectory::figure_eight().samples(&GRAVITY, DT, STEPS);
    let highest = perfect.iter().fold(0.0_f64, |most, sample| most.max(sample.gyro.amax()));
    let mut clipped = perfect.clone();
    for sample in &mut clipped {
        sample.gyro = sample.gyro.map(|rate| rate.clamp(-limit, limit));
    }
    let touched = perfect.iter().zip(&clipped).filter(|(a, b)| a != b).count();
    let [right, wrong] =
        [perfect, clipped].map(|samples| summed(&samples, DT, &ImuBias::default()));
    let [rotation, ..] = sizes(&difference(&right.deltas, &wrong.deltas));
    chapter.number("clip_limit", limit, "rad/s", 1);
    chapter.number("clip_highest", highest, "rad/s", 2);
    chapter.number("clip_percent", 100.0 * touched as f64 / STEPS as f64, "%", 0);
    chapter.number("clip_mrad", 1e3 * rotation, "mrad", 0);
    chapter.number("clip_sigmas", rotation / wrong.sigmas()[0], "", 0);
}

/// Errors of velocity in m/s when the readings of a stretch in the middle of a second are lost, with
/// the Euler rule and with the midpoint rule.
fn with_a_gap(seconds: f64) -> [f64; 2] {
    let motion = Trajectory::figure_eight();
    let missing = (seconds / DT).round() as usize;
    let kept = (0..=STEPS).filter(|k| !(100 < *k && *k < 100 + missing));
    let times: Vec<f64> = kept.map(|k| DT * k as f64).collect();
    let samples: Vec<_> = times.iter().map(|t| motion.at(*t).sample(&GRAVITY)).collect();
    [Rule::Euler, Rule::Midpoint].map(|rule| {
        let mut sums = Preintegrator::new(&ImuBias::default(), &ImuNoise::mems())
            .expect("the noise of a sensor");
        sums.longest_step = f64::INFINITY;
        for (pair, at) in samples.windows(2).zip(times.windows(2)) {
            let dt = at[1] - at[0];
            match rule {
                Rule::Euler => sums.integrate(&pair[0], dt),
                Rule::Midpoint => sums.integrate_midpoint(&pair[0], &pair[1], dt),
            }
            .expect("the readings are finite");
        }
        let found = sums.finish().expect("there is a step").deltas;
        (found.velocity - true_deltas(&motion).velocity).norm()
    })
}

fn gaps(chapter: &mut Chapter) {
    let gap = 0.1;
    let [euler, midpoint] = with_a_gap(gap);
    let [without, without_midpoint] = with_a_gap(DT);
    chapter.number("gap_ms", 1e3 * gap, "ms", 0);
    chapter.number("gap_lost", gap / DT - 1.0, "", 0);
    chapter.number("gap_euler_mm", 1e3 * euler, "mm/s", 0);
    chapter.number("gap_midpoint_mm", 1e3 * midpoint, "mm/s", 1);
    chapter.number("gap_without_mm", 1e3 * without, "mm/s", 0);
    chapter.number("gap_without_midpoint_mm", 1e3 * without_midpoint, "mm/s", 2);
}
