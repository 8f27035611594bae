//! Flies two rounds and a half of a large hall with the multi-state constraint Kalman filter, comes by the
//! same places again, and closes loops.
//!
//! ```text
//! cargo run --release -p vislam --example loop_flight -- [--flights N]
//! ```
//!
//! A keyframe is kept every eighth picture. What the filter believes of each two in a row becomes a
//! measurement of the pose graph, with its covariance. A second camera, which the filter does not use,
//! measures loops: wherever a keyframe stands near one of an earlier round, the pixels of landmarks that
//! both saw say how. Which landmarks are the same, the simulation tells. The lines have, for each
//! flight, how far the keyframes are from the truth by odometry, and after the loops were closed in six
//! and in four degrees of freedom: roots of the mean squares of positions, in centimetres, and of tilts,
//! in milliradians, with yaw and translation aligned.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Vector3};
use vislam::filtering::{
    AlignmentError, Belief, Freedom, RootMeanSquares, absolute_trajectory_error,
};
use vislam::inertial::{BodyPose, NavState};
use vislam::least_squares::{Kernel, Key};
use vislam::loop_closure::{
    LoopClosureError, PoseGraph, RelativeMeasurement, SpatialGraph, StereoPixels, UprightPose,
    pose_graph_options,
};
use vislam::msckf::{Msckf, MsckfOptions, Start};
use vislam::simulation::{
    EulerAngles, Flight, FlightError, FlightRecording, ScalarTrajectory, Trajectory,
};
use vislam::two_views::StereoPinhole;

const USAGE: &str = "usage: loop_flight [--flights N]";

/// Pictures from one keyframe to the next, and the picture of the first one.
pub const SPACING: usize = 8;
const FIRST: usize = 40;
const LANDMARKS: usize = 3000;
/// Metres between the two cameras.
pub const BASELINE: f64 = 0.3;
/// Keyframes are seen again from this near, in metres.
const NEAR: f64 = 2.5;
/// A keyframe that is seen again is so many keyframes old at least.
const OLD: usize = 30;
/// Landmarks that two keyframes must share, and the disparity that each has in both, in pixels.
const SHARED: usize = 10;
const DISPARITY: f64 = 4.0;

/// What is known at the beginning, in the order of [`Start::drawn`].
const SIGMAS: [f64; 15] =
    [5e-3, 5e-3, 1e-3, 0.05, 0.05, 0.05, 1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3, 0.02, 0.02, 0.02];

// ANCHOR: loop_flight
/// Round a hall of sixty metres by forty, a minute for each round.
pub fn flight() -> Flight {
    let wave = ScalarTrajectory::wave;
    let rate = 0.1;
    let position = [wave(30.0, rate, 0.0), wave(20.0, rate, -FRAC_PI_2), wave(0.8, 0.7, 0.0)];
    let (yaw, pitch) = (ScalarTrajectory::linear(rate), wave(0.1, 0.9, 1.0));
    let angles = EulerAngles { yaw, pitch, roll: wave(0.15, 1.3, 0.0) };
    let flight = Flight::new(Trajectory { position, angles, ..Trajectory::default() });
    Flight {
        seconds: 160.0,
        picture_rate: 10.0,
        tracks: 60,
        baseline: Some(BASELINE),
        ..flight.with_lever(Vector3::new(0.1, 0.05, -0.02))
    }
}
// ANCHOR_END: loop_flight

/// What the sensors bring home.
pub fn flown(seed: u64) -> Result<FlightRecording, FlightError> {
    flown_in(seed, seed)
}

/// The same in the room of one seed, with the noise of another.
pub fn flown_in(room: u64, noise: u64) -> Result<FlightRecording, FlightError> {
    let flight = flight();
    flight.record(&flight.room(3.0, LANDMARKS, room)?, noise)
}

/// The keyframes of a flight.
pub struct Keyframes {
    /// Which pictures they are.
    pub pictures: Vec<usize>,
    /// Where they were.
    pub truth: Vec<NavState>,
    /// Where the filter put them, and each as seen from the one before it.
    pub odometry: SpatialGraph,
}

/// Follows a recording with the filter and keeps keyframes.
pub fn keyframes(recording: &FlightRecording, seed: u64) -> Result<Keyframes, Box<dyn Error>> {
    let start = Start::drawn(recording, &SIGMAS, 1000 + seed).ok_or("there is no picture")?;
    let mut filter = Msckf::new(MsckfOptions::of_flight(&recording.flight), &start)?;
    let odometry = PoseGraph { poses: Vec::new(), measurements: Vec::new() };
    let mut keyframes = Keyframes { pictures: Vec::new(), truth: Vec::new(), odometry };
    for number in 0..recording.pictures.len() {
        filter.follow(recording, number)?;
        if number >= FIRST && (number - FIRST).is_multiple_of(SPACING) {
            keep(&mut keyframes.odometry, filter.belief())?;
            keyframes.pictures.push(number);
            keyframes.truth.push(recording.truth.states[number]);
        }
    }
    Ok(keyframes)
}

// ANCHOR: keep_keyframe
/// Adds the newest pose of a filter as a keyframe. The filter still has the last keyframe in its window,
/// so it knows how the two stand to each other.
fn keep(odometry: &mut SpatialGraph, belief: &Belief) -> Result<(), LoopClosureError> {
    let window: Vec<Key<BodyPose>> =
        (0..belief.values().len()).filter_map(|at| belief.values().key(at)).collect();
    let newest = window[window.len() - 1];
    if let Some(last) = odometry.poses.len().checked_sub(1) {
        let before = window[window.len() - 1 - SPACING];
        let seen = RelativeMeasurement::believed(belief, [before, newest], [last, last + 1])?;
        odometry.measurements.push(seen);
    }
    odometry.poses.push(belief.values()[newest].at_rest().pose());
    Ok(())
}
// ANCHOR_END: keep_keyframe

// ANCHOR: shared_sights
/// What two pictures saw of the landmarks that both show to both cameras.
pub fn shared_sights(recording: &FlightRecording, pictures: [usize; 2]) -> Vec<[Vector3<f64>; 2]> {
    let [first, second] = pictures.map(|number| {
        let seen = recording.pictures[number].features.iter().filter_map(|feature| {
            let landmark = recording.truth.landmark_of_track[feature.track];
            Some((landmark, feature.pixel.push(feature.right?.x)))
        });
        seen.collect::<Vec<_>>()
    });
    let again = |landmark: usize| second.iter().find(|(other, _)| *other == landmark);
    first.iter().filter_map(|(landmark, seen)| Some([*seen, again(*landmark)?.1])).collect()
}
// ANCHOR_END: shared_sights

/// A loop from the nearest old keyframe to this one, if there is one near that shares landmarks.
fn closed(
    recording: &FlightRecording,
    keyframes: &Keyframes,
    second: usize,
) -> Result<Option<RelativeMeasurement<Isometry3<f64>, 6>>, Box<dyn Error>> {
    let place = |number: usize| keyframes.truth[number].position;
    let apart = |number: &usize| (place(*number) - place(second)).norm();
    let old = 0..(second + 1).saturating_sub(OLD);
    let nearest = old.min_by(|a, b| apart(a).total_cmp(&apart(b)));
    let Some(first) = nearest.filter(|first| apart(first) < NEAR) else { return Ok(None) };
    let numbers = [first, second];
    let sights = shared_sights(recording, numbers.map(|number| keyframes.pictures[number]));
    if sights.len() < SHARED {
        return Ok(None);
    }
    let flight = &recording.flight;
    let camera = StereoPinhole::new(flight.camera, BASELINE)?;
    let pixels = StereoPixels { camera, sigma: flight.pixel_sigma, least_disparity: DISPARITY };
    let extrinsics = &flight.rig.body_from_camera;
    match RelativeMeasurement::from_stereo(pixels, extrinsics, &sights, numbers) {
        Err(LoopClosureError::Unsure { .. }) => Ok(None),
        found => Ok(Some(found?)),
    }
}

/// All loops, in the order of the keyframes that close them.
pub fn loops(
    recording: &FlightRecording,
    keyframes: &Keyframes,
) -> Result<Vec<RelativeMeasurement<Isometry3<f64>, 6>>, Box<dyn Error>> {
    let all = (0..keyframes.truth.len()).map(|second| closed(recording, keyframes, second));
    Ok(all.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Odometry and loops together.
pub fn with_loops(
    odometry: &SpatialGraph,
    loops: &[RelativeMeasurement<Isometry3<f64>, 6>],
) -> SpatialGraph {
    let mut graph = odometry.clone();
    graph.measurements.extend_from_slice(loops);
    graph
}

// ANCHOR: close_loops
/// The poses after the loops were closed, in six and in four degrees of freedom.
pub fn both_ways(graph: &SpatialGraph) -> Result<[Vec<Isometry3<f64>>; 2], LoopClosureError> {
    let options = pose_graph_options();
    let six = graph.solve(|_| Kernel::Squared, &options)?.poses;
    let four = graph.upright().solve(|_| Kernel::Squared, &options)?.poses;
    Ok([six, four.iter().map(|UprightPose { world_from_body }| *world_from_body).collect()])
}
// ANCHOR_END: close_loops

/// Poses as the states of bodies at rest.
pub fn states(poses: &[Isometry3<f64>]) -> Vec<NavState> {
    let state = |pose: &Isometry3<f64>| NavState {
        world_from_body: pose.rotation.to_rotation_matrix(),
        velocity: Vector3::zeros(),
        position: pose.translation.vector,
    };
    poses.iter().map(state).collect()
}

/// How far poses are from the truth, once yaw and translation are aligned.
pub fn errors(
    poses: &[Isometry3<f64>],
    truth: &[NavState],
) -> Result<RootMeanSquares, AlignmentError> {
    absolute_trajectory_error(&states(poses), truth, Freedom::Four)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let flights = match arguments.as_slice() {
        [] => 5,
        [name, count] if name == "--flights" => count.parse().map_err(|_| USAGE)?,
        _ => return Err(USAGE.into()),
    };
    for seed in 0..flights {
        let recording = flown(seed)?;
        let keyframes = keyframes(&recording, seed)?;
        let loops = loops(&recording, &keyframes)?;
        let graph = with_loops(&keyframes.odometry, &loops);
        let [six, four] = both_ways(&graph)?;
        print!("flight {seed}: {} keyframes, {} loops", keyframes.truth.len(), loops.len());
        let ways = [("odometry", &graph.poses), ("six", &six), ("four", &four)];
        for (name, poses) in ways {
            let RootMeanSquares { position, tilt, .. } = errors(poses, &keyframes.truth)?;
            print!("; {name} {:.1} cm, {:.2} mrad", 100.0 * position, 1e3 * tilt);
        }
        println!();
    }
    Ok(())
}
