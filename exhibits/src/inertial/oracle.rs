//! Random motions, and derivatives by differences.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, SMatrix, Vector3};
use vislam::inertial::CameraImu;
use vislam::simulation::{EulerAngles, ScalarTrajectory, Trajectory};

use crate::random::Random;

/// A motion in which every axis turns and accelerates.
pub fn motion(random: &mut Random) -> Trajectory {
    let mut coordinate = |size: f64| ScalarTrajectory {
        value: size * random.uniform(-1.0..1.0),
        rate: size * random.uniform(-0.3..0.3),
        acceleration: size * random.uniform(-0.1..0.1),
        amplitude: size * random.uniform(0.3..1.0),
        frequency: random.uniform(0.5..2.0),
        phase: random.uniform(0.0..TAU),
    };
    let position = [coordinate(2.0), coordinate(2.0), coordinate(1.0)];
    let angles =
        EulerAngles { yaw: coordinate(1.5), pitch: coordinate(0.5), roll: coordinate(0.8) };
    Trajectory { position, angles, ..Trajectory::default() }
}

/// A camera at the end of a lever arm of 5 to 30 cm, turned in any way.
pub fn camera(random: &mut Random) -> CameraImu {
    let arm = random.uniform(0.05..0.3);
    let lever = random.direction(arm);
    let turn = random.rotation(3.0);
    let body_from_camera = Isometry3::from_parts(lever.into(), turn.into());
    CameraImu { body_from_camera, time_offset: 0.0 }
}

/// First derivative at zero, with an error of fourth order in the step.
pub fn slope<const R: usize, const C: usize>(
    function: impl Fn(f64) -> SMatrix<f64, R, C>,
    step: f64,
) -> SMatrix<f64, R, C> {
    let far = function(-2.0 * step) - function(2.0 * step);
    let near = function(step) - function(-step);
    (8.0 * near + far) / (12.0 * step)
}

/// Second derivative at zero, with an error of fourth order in the step.
pub fn bend(function: impl Fn(f64) -> Vector3<f64>, step: f64) -> Vector3<f64> {
    let near = function(step) + function(-step);
    let far = function(2.0 * step) + function(-2.0 * step);
    (16.0 * near - far - 30.0 * function(0.0)) / (12.0 * step * step)
}
