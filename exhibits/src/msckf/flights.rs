//! Flights with the filter of `examples/filter.rs`.

use nalgebra::{UnitQuaternion, Vector3};
use vislam::consistency::Policy;
use vislam::filtering::{BlockNees, StateError, attitude_in_world};
use vislam::inertial::NavState;
use vislam::msckf::{Msckf, MsckfOptions, PictureReport, Refusals, Rest};
use vislam::simulation::{Flight, FlightRecording, Trajectory};

use crate::chapter::Chapter;
use crate::record::accepted;

#[allow(dead_code)]
#[path = "../../../code/examples/filter.rs"]
pub mod example;

use example::{SIGMAS, fly, start};

/// A flight, and what its sensors bring home.
pub fn flown(flight: &Flight, seed: u64) -> FlightRecording {
    example::flown(flight, seed).expect("it can be flown")
}

/// The options that are true of a flight.
pub fn options(recording: &FlightRecording) -> MsckfOptions {
    MsckfOptions::of_flight(&recording.flight)
}

/// What is seen of a filter after each picture.
#[derive(Clone, Copy)]
pub struct Seen {
    /// Distance from the truth, in metres.
    pub error: f64,
    /// The root of the trace of the covariance of the position, in metres.
    pub sigma: f64,
    /// The standard deviation of yaw, in radians.
    pub yaw: f64,
    /// The error of yaw, in radians.
    pub yaw_error: f64,
    pub report: PictureReport,
}

impl Seen {
    fn of(truth: &NavState, filter: &Msckf, report: &PictureReport) -> Self {
        let covariance = filter.covariance();
        let turn = attitude_in_world(filter.state(), &covariance.fixed_view::<3, 3>(0, 0));
        Self {
            error: (truth.position - filter.state().position).norm(),
            sigma: covariance.fixed_view::<3, 3>(6, 6).trace().sqrt(),
            yaw: turn[(2, 2)].sqrt(),
            yaw_error: StateError::between(filter.state(), truth).yaw(),
            report: *report,
        }
    }
}

/// A flight as the filter goes along.
pub fn followed(recording: &FlightRecording, options: MsckfOptions, seed: u64) -> Vec<Seen> {
    let mut seen = Vec::new();
    fly(recording, options, &start(recording, seed), |number, filter, report| {
        seen.push(Seen::of(&recording.truth.states[number], filter, report));
    })
    .expect("the flight is followed");
    seen
}

/// Root mean square of the distances from the truth, in metres.
pub fn rmse(seen: &[Seen]) -> f64 {
    (seen.iter().map(|seen| seen.error * seen.error).sum::<f64>() / seen.len() as f64).sqrt()
}

/// How rest is noticed, and what the filter is then told.
const REST: Rest = Rest { motion: 3.0, velocity_sigma: 0.01, turning_sigma: 0.01 };

fn hover() -> Flight {
    Flight { motion: Trajectory::hover(), ..example::flight(60.0) }
}

/// A hover of a minute: without a word about rest, and with.
pub fn hovers() -> [Vec<Seen>; 2] {
    let recording = flown(&hover(), 5);
    [None, Some(REST)].map(|rest| {
        let options = MsckfOptions { rest, ..options(&recording) };
        followed(&recording, options, 5)
    })
}

pub fn numbers(chapter: &mut Chapter) {
    size(chapter);
    lengths(chapter);
    hovering(chapter);
    resting(chapter);
    outliers(chapter);
    extrinsics(chapter);
    heading(chapter);
}

/// The flight of a minute, and the filter that follows it.
pub fn minute() -> (FlightRecording, Vec<Seen>) {
    let recording = flown(&example::flight(60.0), 0);
    let seen = followed(&recording, options(&recording), 0);
    (recording, seen)
}

fn size(chapter: &mut Chapter) {
    let (recording, seen) = minute();
    let options = options(&recording);
    chapter.number("window", options.clones as f64, "", 0);
    chapter.number("columns", 15.0 + 6.0 * options.clones as f64, "", 0);
    chapter.number("flight_seconds", recording.flight.seconds, "s", 0);
    chapter.number("flight_pictures", recording.pictures.len() as f64, "", 0);
    chapter.number("flight_tracks", recording.truth.landmark_of_track.len() as f64, "", 0);
    chapter.number("flight_rmse", 100.0 * rmse(&seen), "cm", 1);
    let last = seen.last().expect("there are pictures");
    chapter.number("flight_error", 100.0 * last.error, "cm", 1);
    chapter.number("flight_sigma", 100.0 * last.sigma, "cm", 1);
    let used = seen.iter().map(|seen| seen.report.used).sum::<usize>();
    chapter.number("flight_used", used as f64, "", 0);
    let refused = refused(&seen);
    chapter.number("flight_short", refused.short as f64, "", 0);
    chapter.number("flight_gated", refused.gated as f64, "", 0);
    let rows = seen.iter().map(|seen| seen.report.rows).sum::<usize>() as f64;
    chapter.number("flight_rows", rows / seen.len() as f64, "", 0);
    let columns = 15 + 6 * options.clones;
    let compressed = seen.iter().filter(|seen| seen.report.rows >= columns).count();
    chapter.number("flight_compressed", 100.0 * compressed as f64 / seen.len() as f64, "%", 0);
    shares(chapter, used as f64 / seen.len() as f64);
}

/// Which part of the time of a picture with forty tracks is spent on what, so many tracks being used in it.
fn shares(chapter: &mut Chapter, used: f64) {
    let of = |name| accepted("msckf_cost", name);
    let share = |time: f64| 100.0 * time / of("features_40");
    chapter.number("tracks_used", used, "", 1);
    chapter.number("share_carried", share(of("readings") + of("clone")), "%", 0);
    let each = of("landmark") + of("linearize") + of("project");
    chapter.number("share_tracks", share(used * each), "%", 0);
    chapter.number("share_correct", share(of("correct")), "%", 0);
    chapter.number("length_ratio", of("length_20") / of("length_11"), "", 1);
}

/// In how many pictures a corner is seen, one after another.
fn lengths(chapter: &mut Chapter) {
    let recording = flown(&example::flight(60.0), 0);
    let mut lengths = vec![0_u32; recording.truth.landmark_of_track.len()];
    let features = recording.pictures.iter().flat_map(|picture| &picture.features);
    features.for_each(|feature| lengths[feature.track] += 1);
    lengths.sort_unstable();
    chapter.number("track_median", f64::from(lengths[lengths.len() / 2]), "", 0);
}

fn refused(seen: &[Seen]) -> Refusals {
    seen.iter().fold(Refusals::default(), |sum, seen| {
        let Refusals { short, landmark, unmet, rank, gated } = seen.report.refused;
        Refusals {
            short: sum.short + short,
            landmark: sum.landmark + landmark,
            unmet: sum.unmet + unmet,
            rank: sum.rank + rank,
            gated: sum.gated + gated,
        }
    })
}

fn hovering(chapter: &mut Chapter) {
    let [adrift, told] = hovers();
    let (first, last) = (adrift[0], adrift[adrift.len() - 1]);
    chapter.number("hover_error", last.error, "m", 0);
    chapter.number("hover_sigma", last.sigma, "m", 0);
    chapter.number("hover_yaw_first", 1e3 * first.yaw, "mrad", 1);
    chapter.number("hover_yaw_last", 1e3 * last.yaw, "mrad", 0);
    chapter.number("start_gyro_bias", 1e3 * SIGMAS[9], "mrad/s", 0);
    let refused = refused(&adrift);
    chapter.number("hover_apart", refused.landmark as f64, "", 0);
    chapter.number("hover_vague", refused.rank as f64, "", 0);
    chapter.number("hover_refused", refused.total() as f64, "", 0);
    let last = told[told.len() - 1];
    chapter.number("rest_error", 100.0 * last.error, "cm", 1);
    chapter.number("rest_sigma", 100.0 * last.sigma, "cm", 1);
    chapter.number("rest_yaw", 1e3 * last.yaw, "mrad", 1);
    chapter.number("rest_modest", last.sigma / last.error, "", 0);
    let resting = told.iter().filter(|seen| seen.report.at_rest).count();
    chapter.number("rest_pictures", resting as f64, "", 0);
}

/// Hovers that are told that they rest.
const HOVERS: u64 = 20;

/// How the errors of hovers that are told of their rest compare with what they believe.
fn resting(chapter: &mut Chapter) {
    let mut nees = [0.0; 2];
    for seed in 0..HOVERS {
        let recording = flown(&hover(), seed);
        let told = MsckfOptions { rest: Some(REST), ..options(&recording) };
        let filter = fly(&recording, told, &start(&recording, seed), |_, _, _| ());
        let filter = filter.expect("the hover is followed");
        let truth = recording.truth.states.last().expect("there are pictures");
        let covariance = filter.covariance().fixed_view::<9, 9>(0, 0).into_owned();
        let own = BlockNees::of(filter.state(), truth, &covariance).expect("a covariance");
        nees.iter_mut().zip([own.yaw, own.position]).for_each(|(sum, own)| *sum += own);
    }
    chapter.number("rest_hovers", HOVERS as f64, "", 0);
    chapter.number("rest_nees_yaw", nees[0] / HOVERS as f64, "", 2);
    chapter.number("rest_nees_position", nees[1] / HOVERS as f64, "", 4);
    chapter.number("rest_motion", REST.motion, "px", 0);
    chapter.number("rest_velocity", 100.0 * REST.velocity_sigma, "cm/s", 0);
    chapter.number("rest_turning", 1e3 * REST.turning_sigma, "mrad/s", 0);
    let Flight { noise, imu_rate, .. } = hover();
    let of_reading = noise.discrete(1.0 / imu_rate)[(0, 0)].sqrt();
    chapter.number("rest_reading", 1e3 * of_reading, "mrad/s", 1);
}

/// A flight with wrong pixels, with the gate and without.
fn outliers(chapter: &mut Chapter) {
    let flight = Flight { outliers: 0.02, ..example::flight(20.0) };
    let recording = flown(&flight, 2);
    let gated = followed(&recording, options(&recording), 2);
    let open = MsckfOptions { gate: 1.0, ..options(&recording) };
    let open = followed(&recording, open, 2);
    chapter.number("outlier_percent", 100.0 * flight.outliers, "%", 0);
    chapter.number("outlier_rmse_gated", 100.0 * rmse(&gated), "cm", 1);
    chapter.number("outlier_rmse_open", 100.0 * rmse(&open), "cm", 1);
    chapter.number("outlier_gated", refused(&gated).gated as f64, "", 0);
}

/// A flight whose camera sits otherwise than the filter is told.
fn extrinsics(chapter: &mut Chapter) {
    let recording = flown(&example::flight(20.0), 2);
    let told = |turn: UnitQuaternion<f64>| {
        let mut told = recording.clone();
        told.flight.rig.body_from_camera.rotation = turn;
        let seen = followed(&told, options(&told), 2);
        let used: usize = seen.iter().map(|seen| seen.report.used).sum();
        (100.0 * rmse(&seen), 100.0 * used as f64 / (used + refused(&seen).total()) as f64)
    };
    let right = recording.flight.rig.body_from_camera.rotation;
    let turned = UnitQuaternion::from_scaled_axis(Vector3::x() * EXTRINSIC_OFF.to_radians());
    chapter.number("extrinsic_degrees", EXTRINSIC_OFF, "°", 0);
    chapter.number("extrinsic_right", told(right).0, "cm", 1);
    chapter.number("extrinsic_turned", told(turned * right).0, "cm", 1);
    chapter.number("extrinsic_inverted_used", told(right.inverse()).1, "%", 0);
}

/// By how many degrees a camera is turned against what the filter is told.
const EXTRINSIC_OFF: f64 = 1.0;

/// The standard deviation of yaw with kept landmarks, by the places of linearization.
fn heading(chapter: &mut Chapter) {
    let recording = flown(&example::flight(40.0), 4);
    let yaw = |landmarks, policy: Policy| {
        let linearization = policy.into();
        let options = MsckfOptions { landmarks, linearization, ..options(&recording) };
        let seen = followed(&recording, options, 4);
        1e3 * seen[seen.len() - 1].yaw
    };
    chapter.number("kept", 30.0, "", 0);
    chapter.number("heading_seconds", 40.0, "s", 0);
    chapter.number("heading_none", yaw(0, Policy::Standard), "mrad", 2);
    chapter.number("heading_latest", yaw(30, Policy::Standard), "mrad", 2);
    chapter.number("heading_first", yaw(30, Policy::FirstEstimates), "mrad", 2);
}
