//! A camera that hovers for a minute before the same landmarks.

use nalgebra::{SMatrix, Vector3};
use vislam::consistency::Policy;
use vislam::filtering::{StateError, attitude_in_world};
use vislam::least_squares::Manifold;
use vislam::msckf::{Msckf, MsckfOptions, Start};
use vislam::observability::{four_motions, steps_of_state};
use vislam::preintegration::Matrix15;
use vislam::simulation::{Flight, FlightRecording, Trajectory};

use crate::chapter::Chapter;
use crate::comparison::inverse;
use crate::msckf::flights::example::fly;
use crate::random::Random;
use crate::record::{RecordValue, accepted};

pub const SEEDS: usize = 20;
pub const SECONDS: f64 = 60.0;
const PICTURE_RATE: f64 = 5.0;
/// Landmarks that are kept in the state.
pub const KEPT: usize = 24;
/// Of the flight that is flown for each build.
pub const LIVE_SECONDS: f64 = 5.0;
/// When the yaw is asked for, in seconds.
pub const TIMES: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 5.0, 10.0, 30.0, 60.0];
/// Standard deviations at the beginning, in the order of the state and the biases.
const START: [f64; 15] =
    [0.01, 0.01, 0.03, 0.05, 0.05, 0.05, 1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3, 0.02, 0.02, 0.02];

fn recorded(seconds: f64, seed: u64) -> FlightRecording {
    let motion = Trajectory::about_one_spot();
    let flight =
        Flight { seconds, picture_rate: PICTURE_RATE, tracks: KEPT, ..Flight::new(motion) };
    let room = flight.room(2.5, 250, seed).expect("the hover has a room");
    flight.record(&room, seed).expect("the hover can be flown")
}

fn start(recording: &FlightRecording, seed: u64) -> Start {
    let mut random = Random::new(seed ^ 0x40e);
    let off = START.map(|sigma| random.normal(sigma));
    let (truth, rig) = (&recording.truth, recording.flight.rig);
    Start {
        nanoseconds: rig.imu_nanoseconds(recording.pictures[0].nanoseconds),
        state: truth.states[0].retract(&off[..9]),
        bias: truth.biases[0].retract(&off[9..]),
        covariance: Matrix15::from_diagonal(&START.map(|sigma| sigma * sigma).into()),
        rig,
    }
}

/// The least standard deviation of the yaw, in degrees, of a filter that nothing tells where north is: what a start
/// itself says of a turn of everything about the vertical, which turns its velocity too.
fn least_sigma(start: &Start) -> f64 {
    let mut free = SMatrix::<f64, 15, 4>::zeros();
    let of_state = steps_of_state(&four_motions(&Vector3::z()), &start.state);
    free.fixed_rows_mut::<9>(0).copy_from(&of_state);
    let information = free.transpose() * inverse(start.covariance) * free;
    inverse(information)[(3, 3)].sqrt().to_degrees()
}

/// The standard deviation of the yaw and its error, in degrees.
fn yaw(filter: &Msckf, recording: &FlightRecording, picture: usize) -> [f64; 2] {
    let (state, covariance) = (filter.state(), filter.covariance());
    let variance = attitude_in_world(state, &covariance.fixed_view::<3, 3>(0, 0))[(2, 2)];
    let error = StateError::between(state, &recording.truth.states[picture]);
    [variance.sqrt().to_degrees(), error.yaw().to_degrees()]
}

/// At each of the times.
fn hovered(policy: Policy, seconds: f64, seed: u64) -> [[f64; 2]; 8] {
    let recording = recorded(seconds, seed);
    let options = MsckfOptions {
        linearization: policy.into(),
        landmarks: KEPT,
        clones: 11,
        ..MsckfOptions::of_flight(&recording.flight)
    };
    let mut found = [[f64::NAN; 2]; 8];
    fly(&recording, options, &start(&recording, seed), |number, filter, _| {
        for (time, found) in TIMES.iter().zip(&mut found) {
            if number == (time * PICTURE_RATE).round() as usize {
                *found = yaw(filter, &recording, number);
            }
        }
    })
    .expect("the flight is followed");
    found
}

/// What is believed of the yaw after the first five seconds of one flight, at the latest estimates and
/// at the first.
pub fn live() -> [f64; 2] {
    POLICIES.map(|(_, policy)| hovered(policy, LIVE_SECONDS, 0)[4][0])
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        (
            "flight",
            format!(
                "{SECONDS} s within a metre of one spot, ImuNoise::euroc(), {PICTURE_RATE} pictures a second"
            ),
        ),
        ("kept", format!("{KEPT} landmarks in the state")),
        ("linearization", "at the latest estimates, and at the first".into()),
    ];
    chapter.record("filter_hover", inputs, hover);
}

const POLICIES: [(&str, Policy); 2] =
    [("latest", Policy::Standard), ("first", Policy::FirstEstimates)];

fn hover() -> Vec<RecordValue> {
    let least = (0..SEEDS as u64).map(|seed| least_sigma(&start(&recorded(1.0, seed), seed)));
    let least = (least.map(|sigma| sigma * sigma).sum::<f64>() / SEEDS as f64).sqrt();
    let mut values = vec![
        RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0),
        RecordValue::new("least_sigma", least, "°", 2, 1e-3),
    ];
    for (word, policy) in POLICIES {
        let runs: Vec<_> = (0..SEEDS as u64).map(|seed| hovered(policy, SECONDS, seed)).collect();
        for at in 0..TIMES.len() {
            let mean = |of: &dyn Fn([f64; 2]) -> f64| {
                runs.iter().map(|run| of(run[at])).sum::<f64>() / SEEDS as f64
            };
            let sigma = mean(&|[sigma, _]| sigma * sigma).sqrt();
            let error = mean(&|[_, error]| error * error).sqrt();
            let nees = mean(&|[sigma, error]| (error / sigma).powi(2));
            for (name, value, unit) in
                [("sigma", sigma, "°"), ("error", error, "°"), ("nees", nees, "")]
            {
                let name = format!("{word}_{name}_{at}");
                values.push(RecordValue::new(name, value, unit, 2, 1e-3));
            }
        }
    }
    values
}

/// A value of a policy at each of the times.
pub fn told(policy: &str, name: &str) -> [f64; 8] {
    std::array::from_fn(|at| accepted("filter_hover", &format!("{policy}_{name}_{at}")))
}
