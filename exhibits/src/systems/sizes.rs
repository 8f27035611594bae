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
    /// Landmarks, and the numbers of one.
    landmarks: (usize, usize),
    /// Calibration that is estimated along.
    calibration: usize,
}

impl Window {
    fn without_landmarks(&self) -> usize {
        let state = state().dimension() + ImuBias::default().dimension();
        self.states * state + self.poses * pose() + self.calibration
    }

    fn all(&self) -> usize {
        self.without_landmarks() + self.landmarks.0 * self.landmarks.1
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

/// The features that VINS-Mono follows at most, each with an inverse depth.
const VINS_MONO: Window = Window { states: 11, poses: 0, landmarks: (150, 1), calibration: 0 };

/// The iterations that VINS-Mono allows for a picture.
const ITERATIONS: usize = 8;

/// Of two cameras: pose, four numbers of the pinhole, four of the lens; and the delay of the clock.
fn openvins() -> Window {
    Window { states: 1, poses: 11, landmarks: (50, 3), calibration: 2 * (pose() + 4 + 4) + 1 }
}

/// Landmarks are eliminated, each where it is linearized.
const BASALT: Window = Window { states: 3, poses: 7, landmarks: (0, 3), calibration: 0 };

/// Of a map with many matches; the poses that see the same points are not counted.
const ORB_SLAM3: Window = Window { states: 25, poses: 0, landmarks: (0, 3), calibration: 0 };

pub fn numbers(chapter: &mut Chapter) {
    let openvins = openvins();
    let mut number = |name, value: usize| chapter.number(name, value as f64, "", 0);
    number("vins_states", VINS_MONO.states);
    number("vins_features", VINS_MONO.landmarks.0);
    number("vins_reduced", VINS_MONO.without_landmarks());
    number("vins_all", VINS_MONO.all());
    number("vins_iterations", ITERATIONS);
    number("openvins_poses", openvins.poses);
    number("openvins_kept", openvins.landmarks.0);
    number("openvins_calibration", openvins.calibration);
    number("openvins_all", openvins.all());
    number("basalt_states", BASALT.states);
    number("basalt_poses", BASALT.poses);
    number("basalt_reduced", BASALT.without_landmarks());
    number("orb_states", ORB_SLAM3.states);
    number("orb_reduced", ORB_SLAM3.without_landmarks());
    let one = accepted("window_speed", "landmarks_first");
    chapter.number("window_ms", ITERATIONS as f64 * one, "ms", 1);
    chapter.number("filter_ms", 1e-3 * accepted("msckf_cost", "features_40"), "ms", 2);
}
