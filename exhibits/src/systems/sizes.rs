//! How many unknowns the windows of four systems have, from their configuration for the EuRoC flights.

use nalgebra::{Isometry3, Rotation3, Vector3};
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::Manifold;

use crate::chapter::Chapter;
use crate::record::accepted;

/// What stands in the state of a system.
struct Window {
    /// Rotation, velocity, position and both biases.
    states: usize,
    /// Poses without velocity and biases.
    poses: usize,
    /// Calibration that is estimated along.
    calibration: usize,
}

impl Window {
    fn without_landmarks(&self) -> usize {
        let state = state().dimension() + ImuBias::default().dimension();
        self.states * state + self.poses * pose() + self.calibration
    }
}

fn state() -> NavState {
    NavState {
        world_from_body: Rotation3::identity(),
        velocity: Vector3::zeros(),
        position: Vector3::zeros(),
    }
}

/// The numbers of a step of a pose.
fn pose() -> usize {
    Isometry3::<f64>::identity().dimension()
}

const VINS_MONO: Window = Window { states: 11, poses: 0, calibration: 0 };

/// The corners that VINS-Mono follows in one picture at most.
const VINS_FEATURES: usize = 150;

/// The iterations that VINS-Mono allows for a picture.
const ITERATIONS: usize = 8;

/// As configured, with two cameras. The calibration of each: pose, four numbers of the pinhole, four of the lens; and
/// the delay of the clock.
fn openvins() -> Window {
    Window { states: 1, poses: 11, calibration: 2 * (pose() + 4 + 4) + 1 }
}

/// The landmarks that OpenVINS keeps in its state at most, and the numbers of one.
const OPENVINS_KEPT: [usize; 2] = [50, 3];

const BASALT: Window = Window { states: 3, poses: 7, calibration: 0 };

/// Of a map with many matches; the poses that see the same points are not counted.
const ORB_SLAM3: Window = Window { states: 25, poses: 0, calibration: 0 };

pub fn numbers(chapter: &mut Chapter) {
    let openvins = openvins();
    let mut number = |name, value: usize| chapter.number(name, value as f64, "", 0);
    number("vins_states", VINS_MONO.states);
    number("vins_features", VINS_FEATURES);
    number("vins_reduced", VINS_MONO.without_landmarks());
    number("vins_iterations", ITERATIONS);
    number("openvins_poses", openvins.poses);
    let [kept, numbers] = OPENVINS_KEPT;
    number("openvins_kept", kept);
    number("openvins_calibration", openvins.calibration);
    number("openvins_all", openvins.without_landmarks() + kept * numbers);
    number("basalt_states", BASALT.states);
    number("basalt_poses", BASALT.poses);
    number("basalt_reduced", BASALT.without_landmarks());
    number("orb_states", ORB_SLAM3.states);
    number("orb_reduced", ORB_SLAM3.without_landmarks());
    let one = accepted("window_speed", "landmarks_first");
    chapter.number("window_ms", ITERATIONS as f64 * one, "ms", 1);
    chapter.number("filter_ms", 1e-3 * accepted("msckf_cost", "features_40"), "ms", 2);
}
