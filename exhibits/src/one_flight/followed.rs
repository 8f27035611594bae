//! The estimators, each over the whole minute.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use nalgebra::{Matrix3, Vector3};
use vislam::consistency::Policy;
use vislam::inertial::NavState;
use vislam::msckf::{Msckf, MsckfOptions};
use vislam::odometry::{Estimate, Estimator, Odometry, Progress};
use vislam::simulation::{Flight, FlightRecording};
use vislam::smoother::Smoother;

use super::beginning::newest_alone;
use super::from_above::{Layer, room};
use super::in_and_out::in_and_out;
use super::{SECONDS, SEED, path, picture_at, recording};
use crate::chapter::Chapter;
use crate::figure::Figure;
use crate::filtering::flown::{self, Moment, RIGHT};
use crate::loop_closure::flight::{Closed, closed_on, example::BASELINE, example::SPACING};
use crate::msckf::flights::{self, Seen, example, options};
use crate::smoother::consistency;
use crate::smoother::followed::{self, Followed, rmse};
use crate::statistics::root_mean_square;

/// Of the path so many seconds are drawn, the last ones.
pub const DRAWN: f64 = 10.0;
/// Ellipses stand at every so manieth picture, and so much enlarged, or so much where the map is known.
pub const EVERY: usize = 10;
pub const ENLARGED: f64 = 3.0;
const ON_MAP: f64 = 20.0;

/// A place that is estimated, with its covariance.
pub type Place = (Vector3<f64>, Matrix3<f64>);

/// The last seconds of a path with its ellipses, upon the truth.
fn last_seconds(name: &str, times: f64, places: &[Place]) -> Figure {
    let last = &places[places.len() - picture_at(DRAWN)..];
    let spreads = last.iter().skip(EVERY - 1).step_by(EVERY).map(|(place, own)| (place, *own));
    room(&[
        Layer::truth(path(SECONDS - DRAWN, SECONDS)),
        Layer::line(name, 0, last.iter().map(|(place, _)| place)),
        Layer::ellipses(times, 0, spreads),
    ])
}

/// A filter that knows the map.
fn on_map() -> &'static [Moment] {
    static MOMENTS: OnceLock<Vec<Moment>> = OnceLock::new();
    MOMENTS.get_or_init(|| flown::flown(&RIGHT, recording(), SEED))
}

/// Error, standard deviation and NEES of a filter that knows the map.
pub fn filtered(chapter: &mut Chapter) {
    let moments = on_map();
    let off = moments.iter().map(|moment| 100.0 * moment.error.position.norm());
    let sigma = moments.iter().map(|moment| 100.0 * moment.place.trace().sqrt());
    let whole = moments.iter().map(|moment| moment.whole).sum::<f64>();
    chapter.number("flight_error", root_mean_square(off), "cm", 1);
    chapter.number("flight_sigma", root_mean_square(sigma), "cm", 1);
    chapter.number("flight_nees", whole / moments.len() as f64, "", 2);
    chapter.figure("one_flight", among_landmarks);
}

fn among_landmarks() -> Figure {
    let truth = &recording().truth.states[1..];
    let places = on_map().iter().zip(truth);
    let places = places.map(|(own, truth)| (truth.position - own.error.position, own.place));
    last_seconds("filter with the map", ON_MAP, &places.collect::<Vec<_>>())
}

/// A filter that knows no map; its error and standard deviation are those of the chapter's flight.
pub fn without_map(chapter: &mut Chapter) {
    chapter.figure("one_flight", unmapped);
}

fn unmapped() -> Figure {
    let recording = recording();
    let mut places = Vec::new();
    let start = example::start(recording, SEED);
    let visit = |_, filter: &Msckf, _: &_| {
        let covariance = filter.covariance().fixed_view::<3, 3>(6, 6).into_owned();
        places.push((filter.state().position, covariance));
    };
    example::fly(recording, options(recording), &start, visit).expect("the flight is followed");
    last_seconds("filter without a map", ENLARGED, &places)
}

/// How long the window is followed, in seconds.
const HALF: f64 = 30.0;

/// How much a smoother holds at most, and what it holds in the end.
struct Window {
    most_states: usize,
    most_variables: usize,
    states: Vec<Vector3<f64>>,
    points: Vec<Vector3<f64>>,
    /// The newest state and its covariance.
    newest: Place,
}

fn window() -> &'static Window {
    static WINDOW: OnceLock<Window> = OnceLock::new();
    WINDOW.get_or_init(|| {
        let recording = recording();
        let options = followed::options(recording, Estimator::Smoother).smoother;
        let start = example::start(recording, SEED);
        let mut smoother = Smoother::new(options, &start).expect("a start");
        let mut readings = recording.readings.iter().peekable();
        let (mut most_states, mut most_variables) = (0, 0);
        for picture in &recording.pictures[1..=picture_at(HALF)] {
            while smoother.last_reading().is_none_or(|last| last < picture.nanoseconds) {
                let Some(reading) = readings.next() else { break };
                smoother.reading(*reading).expect("a reading");
            }
            let report = smoother.picture(picture).expect("it is followed");
            most_states = most_states.max(report.states);
            most_variables = most_variables.max(smoother.variables());
        }
        let states = smoother.states().map(|(_, state)| state.position).collect();
        let points = smoother.points().map(|(_, point)| point).collect();
        let covariance = smoother.covariance().fixed_view::<3, 3>(6, 6).into_owned();
        let newest = (smoother.state().1.position, covariance);
        Window { most_states, most_variables, states, points, newest }
    })
}

/// What a window holds, whatever the flight has brought.
pub fn forgotten(chapter: &mut Chapter) {
    let Window { most_states, most_variables, newest: (place, covariance), .. } = window();
    let off = place - recording().truth.states[picture_at(HALF)].position;
    let [all, newest] = newest_alone();
    chapter.number("flight_pictures", picture_at(HALF) as f64 + 1.0, "", 0);
    chapter.number("flight_states", *most_states as f64, "", 0);
    chapter.number("flight_variables", *most_variables as f64, "", 0);
    chapter.number("flight_off", 100.0 * off.norm(), "cm", 1);
    chapter.number("flight_sigma", 100.0 * covariance.trace().sqrt(), "cm", 1);
    chapter.number("flight_before", 100.0 * all, "cm", 4);
    chapter.number("flight_after", 100.0 * newest, "cm", 4);
    chapter.figure("one_flight", kept);
}

fn kept() -> Figure {
    let Window { states, points, .. } = window();
    room(&[
        Layer::truth(path(HALF - DRAWN, HALF)),
        Layer::line("states that are kept", 0, states),
        Layer::points("landmarks that are kept", 1, points),
    ])
}

/// How many landmarks the filters keep whose yaw is compared.
const KEPT: usize = 30;

/// How sure of the yaw two filters are.
pub fn told_apart(chapter: &mut Chapter) {
    let [standard, first] = [Policy::Standard, Policy::FirstEstimates].map(|policy| {
        let linearization = policy.into();
        let told = MsckfOptions { landmarks: KEPT, linearization, ..options(recording()) };
        let seen = flights::followed(recording(), told, SEED);
        seen[seen.len() - 1]
    });
    let mrad = |yaw: f64| 1e3 * yaw.abs();
    let of = |seen: &Seen| [mrad(seen.yaw), mrad(seen.yaw_error)];
    let ([standard, standard_off], [first, first_off]) = (of(&standard), of(&first));
    chapter.number("flight_standard", standard, "mrad", 1);
    chapter.number("flight_standard_off", standard_off, "mrad", 1);
    chapter.number("flight_first", first, "mrad", 1);
    chapter.number("flight_first_off", first_off, "mrad", 1);
}

/// What the smoother says from the start that is known.
fn smoothed() -> &'static Followed {
    static FOLLOWED: OnceLock<Followed> = OnceLock::new();
    FOLLOWED.get_or_init(|| consistency::followed(recording(), Estimator::Smoother, SEED))
}

/// The error of the newest state, and of the same states later.
pub fn waited(chapter: &mut Chapter) {
    let Followed { causal, delayed, .. } = smoothed();
    let truth = &recording().truth.states;
    let newest = rmse(causal.iter().map(|(at, own)| (*at, &own.state)), truth);
    let later = rmse(delayed.iter().map(|(at, state)| (*at, state)), truth);
    let sigma = causal.iter().map(|(_, own)| 100.0 * place_of(own).1.trace().sqrt());
    chapter.number("flight_newest", 100.0 * newest, "cm", 1);
    chapter.number("flight_sigma", root_mean_square(sigma), "cm", 1);
    chapter.number("flight_later", 100.0 * later, "cm", 1);
    chapter.figure("one_flight", smooth);
}

/// The place of an estimate, and its covariance.
fn place_of(estimate: &Estimate) -> Place {
    let covariance = estimate.covariance.fixed_view::<3, 3>(6, 6).into_owned();
    (estimate.state.position, covariance)
}

fn smooth() -> Figure {
    let places: Vec<Place> = smoothed().causal.iter().map(|(_, own)| place_of(own)).collect();
    last_seconds("smoother", ENLARGED, &places)
}

/// The share of wrong pixels, and when readings are lost, in seconds, on the flight with faults.
const WRONG: f64 = 0.02;
const GAP: [f64; 2] = [30.0, 31.0];

/// The same flight with faults.
fn with_faults() -> FlightRecording {
    flights::flown(&Flight { outliers: WRONG, gap: Some(GAP), ..recording().flight.clone() }, SEED)
}

/// What an odometry knew that began with nothing, world by world.
#[derive(Default)]
struct Whole {
    /// For each world the times in seconds, the true states and what was known of them.
    worlds: Vec<Vec<(f64, NavState, Estimate)>>,
    /// The landmarks of the last seconds.
    points: BTreeMap<usize, Vector3<f64>>,
}

fn whole() -> &'static Whole {
    static WHOLE: OnceLock<Whole> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let recording = with_faults();
        let truth = |nanoseconds: i64| recording.flight.motion.at(1e-9 * nanoseconds as f64).state;
        let mut odometry = Odometry::new(followed::options(&recording, Estimator::Smoother));
        let mut whole = Whole::default();
        let told = |odometry: &Odometry, progress| {
            let Progress::Following { .. } = progress else { return };
            let Some((begun, newest)) = odometry.beginning().zip(odometry.newest()) else { return };
            let world = begun.to_world_of(&truth(begun.origin.0));
            let own = newest.in_world(&world);
            whole.worlds.resize_with(odometry.worlds(), Vec::new);
            let seconds = 1e-9 * own.nanoseconds as f64;
            if let Some(states) = whole.worlds.last_mut() {
                states.push((seconds, truth(own.nanoseconds), own));
            }
            if seconds > SECONDS - DRAWN {
                let points = odometry.points().into_iter();
                whole.points.extend(points.map(|(track, place)| (track, world.point(&place))));
            }
        };
        odometry.fly(&recording.readings, &recording.pictures, told).expect("it is flown");
        whole
    })
}

/// The flight with faults, from its beginning to its end.
pub fn from_nothing(chapter: &mut Chapter) {
    let worlds = &whole().worlds;
    let off = |(_, truth, own): &(f64, NavState, Estimate)| {
        100.0 * (truth.position - own.state.position).norm()
    };
    let ends: Vec<f64> = worlds.iter().filter_map(|world| world.last().map(off)).collect();
    let all = worlds.iter().flatten().map(off);
    chapter.number("flight_wrong", 100.0 * WRONG, "%", 0);
    chapter.number("flight_gap", GAP[1] - GAP[0], "s", 0);
    chapter.number("flight_begun", worlds[0][0].0, "s", 1);
    chapter.number("flight_again", worlds[worlds.len() - 1][0].0 - GAP[1], "s", 1);
    chapter.number("flight_end", ends[ends.len() - 1], "cm", 1);
    let (_, _, last) = worlds[worlds.len() - 1].last().expect("it was followed");
    chapter.number("flight_sigma", 100.0 * place_of(last).1.trace().sqrt(), "cm", 1);
    chapter.number("flight_rmse", root_mean_square(all), "cm", 1);
    chapter.figure("one_flight", to_the_end);
    chapter.figure("in_and_out", in_and_out);
}

/// The last seconds of what was known: places and landmarks.
pub fn last_known() -> (Vec<Place>, Vec<Vector3<f64>>) {
    let Whole { worlds, points } = whole();
    let last = worlds.last().into_iter().flatten();
    let last = last.filter(|(seconds, ..)| *seconds > SECONDS - DRAWN);
    (last.map(|(_, _, own)| place_of(own)).collect(), points.values().copied().collect())
}

fn to_the_end() -> Figure {
    let (places, points) = last_known();
    let spreads = places.iter().skip(EVERY - 1).step_by(EVERY).map(|(place, own)| (place, *own));
    room(&[
        Layer::truth(path(SECONDS - DRAWN, SECONDS)),
        Layer::line("odometry", 0, places.iter().map(|(place, _)| place)),
        Layer::points("landmarks", 1, &points),
        Layer::ellipses(ENLARGED, 0, spreads),
    ])
}

/// The same flight with a second camera, which finds places again.
fn found_again() -> &'static Closed {
    static CLOSED: OnceLock<Closed> = OnceLock::new();
    CLOSED.get_or_init(|| {
        let flight = Flight { baseline: Some(BASELINE), ..recording().flight.clone() };
        closed_on(&flights::flown(&flight, SEED), SEED)
    })
}

/// The filter's keyframes before and after their loops were closed.
pub fn recognized(chapter: &mut Chapter) {
    let closed = found_again();
    let [odometry, _, four] = closed.errors();
    chapter.number("flight_keyframes", closed.keyframes.truth.len() as f64, "", 0);
    chapter.number("flight_loops", closed.loops().len() as f64, "", 0);
    chapter.number("flight_odometry", 100.0 * odometry.position, "cm", 1);
    chapter.number("flight_closed", 100.0 * four.position, "cm", 1);
    chapter.figure("one_flight", loops);
}

fn loops() -> Figure {
    let closed = found_again();
    let last = closed.keyframes.truth.len() - picture_at(DRAWN) / SPACING;
    let line =
        |name, series, poses| Layer::line(name, series, &closed.drawn(&closed.off(poses))[last..]);
    room(&[
        Layer::truth(path(SECONDS - DRAWN, SECONDS)),
        line("odometry", 1, &closed.graph.poses),
        line("loops closed", 0, &closed.four),
    ])
}
