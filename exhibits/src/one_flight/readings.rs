//! What the readings alone say.

use nalgebra::{Matrix3, Rotation3, Vector3};
use vislam::inertial::{ImuBias, NavState, StampedSample, between};
use vislam::manifold::so3;
use vislam::preintegration::{CombinedPreintegrated, preintegrate_combined};

use super::from_above::{Layer, is_inside, room};
use super::{path, picture_at, recording};
use crate::chapter::Chapter;
use crate::figure::Figure;

/// How many seconds of turns are added and multiplied.
const TURNS: f64 = 10.0;
/// Until when readings are summed up, in seconds.
const SHORT: f64 = 10.0;
const LONG: f64 = 60.0;
/// How long one of the sums is, in seconds.
const SUM: f64 = 0.1;
/// How long the path is that is drawn, in seconds.
const DRAWN: f64 = 14.0;

/// The readings of a span of seconds.
fn readings(from: f64, to: f64) -> Vec<StampedSample> {
    let [from, to] = [from, to].map(|seconds| (1e9 * seconds).round() as i64);
    between(&recording().readings, from, to).expect("readings cover the flight")
}

/// The turns of the gyroscope, added as vectors and multiplied as rotations.
pub fn turns(chapter: &mut Chapter) {
    let readings = readings(0.0, TURNS);
    let turns = readings.windows(2).map(|pair| {
        0.5 * pair[0].seconds_to(&pair[1]) * (pair[0].sample.gyro + pair[1].sample.gyro)
    });
    let turns: Vec<Vector3<f64>> = turns.collect();
    let added = so3::exp(&turns.iter().sum());
    let multiplied =
        turns.iter().fold(Rotation3::identity(), |turned, turn| so3::retract(&turned, turn));
    let state = |seconds| recording().truth.states[picture_at(seconds)].world_from_body;
    let truth = state(0.0).inverse() * state(TURNS);
    let off = |found: &Rotation3<f64>| so3::local(found, &truth).norm().to_degrees();
    chapter.number("flight_seconds", TURNS, "s", 0);
    chapter.number("flight_turns", turns.len() as f64, "", 0);
    chapter.number("flight_added", off(&added), "°", 0);
    chapter.number("flight_multiplied", off(&multiplied), "°", 2);
    chapter.number("flight_sigma", turn_sigma(TURNS).to_degrees(), "°", 2);
}

/// The standard deviation of the turn of the first seconds by the noise of the readings, in radians.
fn turn_sigma(seconds: f64) -> f64 {
    sums(0.0, seconds).covariance().fixed_view::<3, 3>(0, 0).trace().sqrt()
}

/// Where the readings lead from the true start, reading by reading.
fn alone(seconds: f64) -> Vec<NavState> {
    let recording = recording();
    let mut states = vec![recording.truth.states[0]];
    for pair in readings(0.0, seconds).windows(2) {
        let dt = pair[0].seconds_to(&pair[1]);
        let last = states[states.len() - 1];
        let gravity = &recording.flight.gravity;
        states.push(last.propagate_midpoint(&pair[0].sample, &pair[1].sample, gravity, dt));
    }
    states
}

/// How far a place is from the truth at a time, in metres.
fn off(state: &NavState, seconds: f64) -> f64 {
    (state.position - recording().truth.states[picture_at(seconds)].position).norm()
}

/// The path by readings alone.
pub fn dead_reckoning(chapter: &mut Chapter) {
    let states = alone(LONG);
    let at = |seconds: f64| &states[(seconds * recording().flight.imu_rate).round() as usize];
    chapter.number("flight_short", SHORT, "s", 0);
    chapter.number("flight_short_off", 100.0 * off(at(SHORT), SHORT), "cm", 0);
    chapter.number("flight_long", LONG, "s", 0);
    chapter.number("flight_long_off", off(at(LONG), LONG), "m", 1);
    chapter.figure("one_flight", lost);
}

fn lost() -> Figure {
    let states = alone(LONG);
    let inside = |place: &&Vector3<f64>| is_inside(&(place.x, place.y));
    let line = states.iter().step_by(10).map(|state| &state.position).take_while(inside);
    room(&[Layer::truth(path(0.0, LONG)), Layer::line("readings alone", 0, line)])
}

/// The sums of a span of seconds, at biases of zero.
fn sums(from: f64, to: f64) -> CombinedPreintegrated {
    preintegrate_combined(&readings(from, to), &ImuBias::default(), &recording().flight.noise)
        .expect("there are readings")
}

/// Where the sums from picture to picture lead from the true start, with a bias for each of them.
fn joined(bias: impl Fn(usize) -> ImuBias) -> NavState {
    let recording = recording();
    let count = (LONG / SUM).round() as usize;
    (0..count).fold(recording.truth.states[0], |state, k| {
        let of = sums(SUM * k as f64, SUM * (k + 1) as f64);
        of.sums.predict(&state, &recording.flight.gravity, &bias(k))
    })
}

/// The readings, summed up from picture to picture.
pub fn summed(chapter: &mut Chapter) {
    chapter.number("flight_readings", readings(0.0, LONG).len() as f64, "", 0);
    chapter.number("flight_sums", LONG / SUM, "", 0);
    chapter.number("flight_end", off(&joined(|_| ImuBias::default()), LONG), "m", 1);
    let truth = |k: usize| recording().truth.biases[picture_at(SUM * k as f64)];
    chapter.number("flight_unbiased", off(&joined(truth), LONG), "m", 1);
}

/// Where the sums from the start lead until a time, and the covariance of the place.
fn predicted(seconds: f64) -> (NavState, Matrix3<f64>) {
    let start = recording().truth.states[0];
    let sums = sums(0.0, seconds).sums;
    let turn = start.world_from_body.matrix();
    let own = sums.covariance.fixed_view::<3, 3>(6, 6);
    let covariance = turn * own * turn.transpose();
    (sums.predict(&start, &recording().flight.gravity, &ImuBias::default()), covariance)
}

/// The standard deviation that is predicted, beside the error.
pub fn spread(chapter: &mut Chapter) {
    let [short, long] = [SHORT, LONG].map(predicted);
    chapter.number("flight_short", SHORT, "s", 0);
    chapter.number("flight_short_off", 100.0 * off(&short.0, SHORT), "cm", 0);
    chapter.number("flight_short_sigma", 100.0 * short.1.trace().sqrt(), "cm", 0);
    chapter.number("flight_long_off", off(&long.0, LONG), "m", 1);
    chapter.number("flight_long_sigma", long.1.trace().sqrt(), "m", 1);
    chapter.figure("one_flight", spreading);
}

fn spreading() -> Figure {
    let times = |every: f64| (1..).map(move |k| every * f64::from(k)).take_while(|t| *t <= DRAWN);
    let spreads: Vec<_> = times(2.0).map(predicted).collect();
    let states = alone(DRAWN);
    room(&[
        Layer::truth(path(0.0, DRAWN)),
        Layer::line("readings alone", 0, states.iter().step_by(10).map(|state| &state.position)),
        Layer::ellipses(1.0, 0, spreads.iter().map(|(state, spread)| (&state.position, *spread))),
    ])
}
