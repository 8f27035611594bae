//! A flight through a hall, with loops.

use std::sync::OnceLock;

use nalgebra::{Isometry3, Vector3};
use vislam::filtering::{Freedom, RootMeanSquares, absolute_trajectory_error, aligned};
use vislam::loop_closure::{RelativeMeasurement, SpatialGraph};
use vislam::simulation::FlightRecording;

use crate::chapter::Chapter;
use crate::record::{RecordValue, accepted};
use crate::statistics::median;

#[allow(dead_code)]
#[path = "../../../code/examples/loop_flight.rs"]
pub mod example;

use example::{Keyframes, both_ways, errors, flown, flown_in, keyframes, loops, with_loops};

/// A flight before and after its loops were closed.
pub struct Closed {
    pub keyframes: Keyframes,
    pub graph: SpatialGraph,
    /// How many of the measurements are odometry; the others are loops.
    pub odometry: usize,
    pub six: Vec<Isometry3<f64>>,
    pub four: Vec<Isometry3<f64>>,
}

impl Closed {
    pub fn loops(&self) -> &[RelativeMeasurement<Isometry3<f64>, 6>] {
        &self.graph.measurements[self.odometry..]
    }

    /// How far the poses of the filter, of six and of four degrees of freedom are from the truth.
    pub fn errors(&self) -> [RootMeanSquares; 3] {
        [&self.graph.poses, &self.six, &self.four].map(|poses| self.errors_of(poses))
    }

    /// The same of six degrees of freedom, with the whole path turned upright.
    fn levelled(&self) -> RootMeanSquares {
        let poses = example::states(&self.six);
        absolute_trajectory_error(&poses, &self.keyframes.truth, Freedom::Six).expect("as before")
    }

    /// Positions less the true ones, once yaw and translation are aligned.
    pub fn off(&self, poses: &[Isometry3<f64>]) -> Vec<Vector3<f64>> {
        let truth = &self.keyframes.truth;
        let own = aligned(&example::states(poses), truth, Freedom::Four).expect("as before");
        own.iter().zip(truth).map(|(own, truth)| own.position - truth.position).collect()
    }

    /// Where the figures draw keyframes with these errors of position: at ten times the errors.
    pub fn drawn(&self, off: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let both = self.keyframes.truth.iter().zip(off);
        both.map(|(truth, off)| truth.position + 10.0 * off).collect()
    }

    pub fn errors_of(&self, poses: &[Isometry3<f64>]) -> RootMeanSquares {
        errors(poses, &self.keyframes.truth).expect("it goes somewhere")
    }

    /// The mean of squared errors of measurements at the truth, by what each has of degrees of freedom: odometry and
    /// loops in six, and loops in four.
    fn squares(&self) -> [f64; 3] {
        let truth = self.keyframes.truth.iter().map(|state| state.pose()).collect();
        let six = self.graph.with_poses(truth);
        let four = six.upright();
        let (odometry, all) = (0..self.odometry, self.odometry..self.graph.measurements.len());
        let mean = |squares: Vec<f64>| squares.iter().sum::<f64>() / squares.len() as f64;
        [
            mean(odometry.filter_map(|at| six.squared_error(at)).collect()),
            mean(all.clone().filter_map(|at| six.squared_error(at)).collect()),
            mean(all.filter_map(|at| four.squared_error(at)).collect()),
        ]
    }
}

/// Flies, and closes the loops.
fn closed(seed: u64) -> Closed {
    closed_on(&flown(seed).expect("it can be flown"), seed)
}

/// Follows a recording, and closes its loops.
pub fn closed_on(recording: &FlightRecording, seed: u64) -> Closed {
    let keyframes = keyframes(recording, seed).expect("it is followed");
    closed_by(keyframes, recording)
}

/// The same keyframes with loops from pixels that the filter never saw: other noise in pictures of the same room.
fn closed_afresh(keyframes: Keyframes, seed: u64) -> Closed {
    closed_by(keyframes, &flown_in(seed, AFRESH + seed).expect("it can be flown"))
}

/// Keyframes with the loops that a recording of the flight shows.
fn closed_by(keyframes: Keyframes, seen: &FlightRecording) -> Closed {
    let loops = loops(seen, &keyframes).expect("landmarks are seen again");
    let graph = with_loops(&keyframes.odometry, &loops);
    let [six, four] = both_ways(&graph).expect("it has a minimum");
    let odometry = keyframes.odometry.measurements.len();
    Closed { keyframes, graph, odometry, six, four }
}

/// The flight of the figures.
pub const SHOWN: u64 = 1;

/// That flight, flown once.
pub fn shown() -> &'static Closed {
    static SHOWN_ONCE: OnceLock<Closed> = OnceLock::new();
    SHOWN_ONCE.get_or_init(|| closed(SHOWN))
}

pub fn numbers(chapter: &mut Chapter) {
    let closed = shown();
    chapter.number("keyframes", closed.keyframes.truth.len() as f64, "", 0);
    chapter.number("loops", closed.loops().len() as f64, "", 0);
    let flight = example::flight();
    chapter.number("seconds", flight.seconds, "s", 0);
    chapter.number("every", example::SPACING as f64 / flight.picture_rate, "s", 1);
    let places = closed.keyframes.truth.windows(2);
    let length: f64 = places.map(|pair| (pair[1].position - pair[0].position).norm()).sum();
    chapter.number("metres", length, "m", 0);
    let [odometry, six, four] = closed.errors();
    chapter.number("rmse_odometry", 100.0 * odometry.position, "cm", 0);
    chapter.number("rmse_six", 100.0 * six.position, "cm", 0);
    chapter.number("rmse_four", 100.0 * four.position, "cm", 0);
    chapter.number("tilt_odometry", 1e3 * odometry.tilt, "mrad", 1);
    chapter.number("tilt_six", 1e3 * six.tilt, "mrad", 1);
    let covariance = closed.loops()[0].information.try_inverse().expect("positive");
    let sigma = |first: usize| (covariance.fixed_view::<3, 3>(first, first).trace() / 3.0).sqrt();
    chapter.number("loop_metres", 100.0 * sigma(0), "cm", 0);
    chapter.number("loop_turn", 1e3 * sigma(3), "mrad", 1);
    recorded(chapter);
}

const FLIGHTS: u64 = 50;
/// What is added to the seed of a flight for other noise.
const AFRESH: u64 = 10_000;

pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("flights", format!("0 to {}", FLIGHTS - 1)),
        ("flight", "that of examples/loop_flight.rs".to_owned()),
    ];
    chapter.record("loop_flights", inputs, flights);
}

fn flights() -> Vec<RecordValue> {
    let all: Vec<([RootMeanSquares; 5], [f64; 3])> = (0..FLIGHTS)
        .map(|seed| {
            let closed = closed(seed);
            let ([odometry, six, four], levelled) = (closed.errors(), closed.levelled());
            let squares = closed.squares();
            let [_, _, afresh] = closed_afresh(closed.keyframes, seed).errors();
            ([odometry, six, four, levelled, afresh], squares)
        })
        .collect();
    let of = |way: usize, what: fn(&RootMeanSquares) -> f64| {
        median(all.iter().map(|(errors, _)| what(&errors[way])))
    };
    let mean =
        |at: usize| all.iter().map(|(_, squares)| squares[at]).sum::<f64>() / all.len() as f64;
    let worse = |way: usize, than: usize| {
        let worse =
            |(errors, _): &&([RootMeanSquares; 5], _)| errors[way].position > errors[than].position;
        all.iter().filter(worse).count() as f64
    };
    let value = |name, value, unit, decimals| RecordValue::new(name, value, unit, decimals, 1e-2);
    vec![
        RecordValue::new("flights", FLIGHTS as f64, "", 0, 0.0),
        value("rmse_odometry", 100.0 * of(0, |e| e.position), "cm", 0),
        value("rmse_six", 100.0 * of(1, |e| e.position), "cm", 0),
        value("rmse_four", 100.0 * of(2, |e| e.position), "cm", 0),
        value("rmse_levelled", 100.0 * of(3, |e| e.position), "cm", 0),
        value("tilt_levelled", 1e3 * of(3, |e| e.tilt), "mrad", 1),
        value("rmse_afresh", 100.0 * of(4, |e| e.position), "cm", 0),
        value("tilt_odometry", 1e3 * of(0, |e| e.tilt), "mrad", 1),
        value("tilt_six", 1e3 * of(1, |e| e.tilt), "mrad", 1),
        value("square_odometry", mean(0), "", 1),
        value("square_loops", mean(1), "", 1),
        value("square_upright", mean(2), "", 1),
        RecordValue::new("worse_six", worse(1, 0), "", 0, 0.5),
        RecordValue::new("worse_four", worse(2, 0), "", 0, 0.5),
        RecordValue::new("six_behind_four", worse(1, 2), "", 0, 0.5),
    ]
}

fn recorded(chapter: &mut Chapter) {
    let of = |name: &str| accepted("loop_flights", name);
    chapter.number("tilt_ratio", of("tilt_six") / of("tilt_odometry"), "", 1);
}
