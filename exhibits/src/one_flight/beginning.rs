//! What pictures and readings say together of the first seconds.

use std::sync::OnceLock;

use nalgebra::Vector3;
use vislam::inertial::NavState;
use vislam::initialization::{MotionOptions, Started};
use vislam::least_squares::Problem;
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::simulation::Flight;

use super::from_above::{Layer, room};
use super::{SECONDS, path, picture_at, place_of, recording, states};
use crate::chapter::Chapter;
use crate::figure::Figure;
use crate::initialization::flights::{THINNED, started};
use crate::initialization::judged::Judged;
use crate::observability::worked::{free, log_distance};
use crate::statistics::root_mean_square;

/// How long the window is, in seconds, and how many of its pictures a second are used.
const WINDOW: f64 = 2.0;
const RATE: f64 = 5.0;
/// A start is tried every so many seconds.
const EVERY: f64 = 0.5;

/// The window of the first seconds as perfect sensors would have it, with the landmarks that were followed.
fn window() -> Window {
    let recording = recording();
    let flight = Flight { seconds: WINDOW, picture_rate: RATE, ..recording.flight.clone() };
    let features = recording.pictures[..=picture_at(WINDOW)].iter().flat_map(|p| &p.features);
    let mut tracks: Vec<usize> = features.map(|feature| feature.track).collect();
    tracks.sort_unstable();
    tracks.dedup();
    let landmarks: Vec<Vector3<f64>> = tracks.into_iter().map(place_of).collect();
    flight.window(&landmarks, BiasAssumption::CONSTANT).expect("the flight is finite")
}

/// What a window leaves free, and how sure it is of the scale.
pub fn sure_of_scale(chapter: &mut Chapter) {
    let window = window();
    let free = free(&window);
    let sigma = free.spectrum.sigma(&log_distance(&window)).expect("the scale is determined");
    chapter.number("flight_window", WINDOW, "s", 0);
    chapter.number("flight_free", free.count() as f64, "", 0);
    chapter.number("flight_scale", 100.0 * sigma, "%", 1);
}

/// The start in motion with the pictures until the first time that is enough, in seconds, and that time.
fn begun() -> &'static (Started, f64) {
    static BEGUN: OnceLock<(Started, f64)> = OnceLock::new();
    BEGUN.get_or_init(|| {
        let recording = recording();
        let start = |seconds: f64| started(recording, seconds, &MotionOptions::default()).ok();
        let times = (1..).map(|k| EVERY * f64::from(k));
        times
            .map(|seconds| Some((start(seconds)?, seconds)))
            .find_map(|found| found)
            .expect("it bends")
    })
}

/// How sure a start is of its newest position, in metres, with all that it began with, and when all older states and
/// the landmarks are marginalized.
pub fn newest_alone() -> [f64; 2] {
    let (_, seconds) = begun();
    let started = started(recording(), *seconds, &MotionOptions::default()).expect("it begins");
    let Started { batch, values, .. } = started;
    let (newest, last) = (batch.states[batch.states.len() - 1], batch.states.len() - 1);
    let landmarks = batch.landmarks.values().map(|key| key.index());
    let older = batch.states[..last].iter().map(|key| key.index());
    let older = older.chain(batch.biases[..last].iter().map(|key| key.index()));
    let gone: Vec<usize> = landmarks.chain(older).collect();
    let mut problem = batch.problem;
    let sigma = |problem: &Problem| {
        let covariance = problem.covariance(&values).expect("it is determined");
        covariance.of(newest).expect("of a state").fixed_view::<3, 3>(6, 6).trace().sqrt()
    };
    let before = sigma(&problem);
    problem.marginalize(&values, &gone).expect("they can go");
    [before, sigma(&problem)]
}

/// The states of the beginning in the world of the truth, with the true ones.
fn beside_truth() -> Vec<(NavState, NavState)> {
    let (started, _) = begun();
    let truth = &states(0.0, SECONDS);
    let pictures: Vec<usize> = started.pictures.iter().map(|picture| THINNED * picture).collect();
    let world = Similarity::between(&started.first(), &truth[pictures[0]]);
    let none = Vector3::zeros();
    let own =
        started.batch.states.iter().map(|key| world.state(&started.values[*key], &none, &none));
    own.zip(pictures).map(|(own, picture)| (own, truth[picture])).collect()
}

/// A start from nothing.
pub fn from_nothing(chapter: &mut Chapter) {
    let (started, seconds) = begun();
    let truth: Vec<NavState> = states(0.0, SECONDS).iter().step_by(THINNED).copied().collect();
    let judged = Judged::of(started, &truth);
    let missed = beside_truth().into_iter();
    let missed = missed.map(|(own, truth)| 100.0 * (own.position - truth.position).norm());
    chapter.number("flight_begun", *seconds, "s", 1);
    chapter.number("flight_scale", 100.0 * judged.scale.abs(), "%", 1);
    chapter.number("flight_scale_sigma", 100.0 * judged.scale_sigma, "%", 1);
    chapter.number("flight_tilt", judged.tilt.degrees(), "°", 2);
    chapter.number("flight_path", root_mean_square(missed), "cm", 1);
    chapter.figure("one_flight", first_seconds);
}

fn first_seconds() -> Figure {
    let states = beside_truth();
    let places: Vec<Vector3<f64>> = states.iter().map(|(own, _)| own.position).collect();
    let started = &begun().0;
    let spread = |at: usize| {
        let covariance = started.covariance.of(started.batch.states[at]).expect("of a state");
        covariance.fixed_view::<3, 3>(6, 6).into_owned()
    };
    let spreads = (1..places.len()).step_by(2).map(|at| (&places[at], spread(at)));
    room(&[
        Layer::truth(path(0.0, 10.0)),
        Layer::line("known at the beginning", 0, &places),
        Layer::ellipses(1.0, 0, spreads),
    ])
}
