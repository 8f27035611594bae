//! Random states, rigs and windows.

use nalgebra::{Isometry3, Vector3};
use vislam::inertial::{CameraImu, GRAVITY, NavState};
use vislam::observability::{BiasAssumption, Similarity, Window};
use vislam::simulation::{EulerAngles, Flight, ScalarTrajectory, Trajectory};

use super::worked::of_flight;
use crate::random::Random;

pub fn state(random: &mut Random) -> NavState {
    NavState {
        world_from_body: random.rotation(3.0),
        velocity: random.direction(2.0),
        position: random.direction(4.0),
    }
}

/// A camera on an arm of up to half a metre.
pub fn rig(random: &mut Random) -> CameraImu {
    let lever = random.uniform(0.1..0.5);
    let (lever, rotation) = (random.direction(lever), random.rotation(3.0));
    CameraImu {
        body_from_camera: Isometry3::from_parts(lever.into(), rotation.into()),
        time_offset: 0.0,
    }
}

pub fn similarity(random: &mut Random) -> Similarity {
    Similarity {
        scale: random.logarithmic(0.5..2.0),
        rotation: random.rotation(2.0),
        translation: random.direction(3.0),
    }
}

fn coordinate(random: &mut Random, size: f64) -> ScalarTrajectory {
    ScalarTrajectory {
        value: random.uniform(-size..size),
        rate: random.uniform(-size..size),
        acceleration: random.uniform(-size..size),
        amplitude: random.uniform(-size..size),
        frequency: random.uniform(0.5..2.0),
        phase: random.uniform(0.0..6.0),
    }
}

pub fn angles(random: &mut Random) -> EulerAngles {
    EulerAngles {
        yaw: coordinate(random, 0.5),
        pitch: coordinate(random, 0.3),
        roll: coordinate(random, 0.5),
    }
}

pub fn motion(random: &mut Random) -> Trajectory {
    let position = [coordinate(random, 0.7), coordinate(random, 0.7), coordinate(random, 0.5)];
    Trajectory { position, angles: angles(random), ..Trajectory::default() }
}

/// Four pictures of a motion at the truth, with known biases.
pub fn short_window(motion: Trajectory, lever: Vector3<f64>) -> Window {
    let flight = Flight { seconds: 0.75, ..Flight::brief(motion) }.with_lever(lever);
    of_flight(&flight, BiasAssumption::KNOWN)
}

/// Four pictures of a random motion, and an estimate that is off by decimetres.
pub fn wrong_window(random: &mut Random) -> Window {
    let lever = random.direction(0.2);
    let window = short_window(motion(random), lever);
    let step: Vec<f64> = (0..window.dimension()).map(|_| random.uniform(-0.03..0.03)).collect();
    window.retract(&step)
}

/// An acceleration with a part along gravity, in m/s².
pub fn climbing(random: &mut Random) -> Vector3<f64> {
    let level = random.direction(2.0);
    let up = random.uniform(0.1..1.0) * if random.uniform(0.0..1.0) < 0.5 { -1.0 } else { 1.0 };
    Vector3::new(level.x, level.y, up)
}

/// Gravity of any direction and about the usual strength.
pub fn gravity(random: &mut Random) -> Vector3<f64> {
    let strength = random.uniform(0.8..1.2) * GRAVITY.norm();
    random.direction(strength)
}
