//! The most likely scale, direction of down, velocities and biases for a motion of a known shape.

use nalgebra::{DMatrix, Isometry3, Vector1, Vector3};

use super::alignment::intervals;
use super::{Alignment, AlignmentRefused, Sensors, VisualMotion};
use crate::factors::{InertialFactor, PoseUpToScale, Prior};
use crate::inertial::{Gravity, ImuBias, NavState, StampedSample};
use crate::least_squares::{Kernel, Key, Options, Problem, ProblemError};

// ANCHOR: inertial_map
/// What readings say of a motion that pictures have found up to scale.
#[derive(Debug, Clone, PartialEq)]
pub struct InertialMap {
    /// Metres in a unit of the motion.
    pub scale: f64,
    /// The standard deviation of the scale, as a part of it.
    pub scale_sigma: f64,
    /// Gravity, in the coordinates of the motion, in m/s².
    pub gravity: Vector3<f64>,
    /// The covariance of its direction, by [`Gravity`]'s step.
    pub gravity_covariance: DMatrix<f64>,
    /// The bias, which holds for the whole motion.
    pub bias: ImuBias,
    /// The states, along the axes of the motion, in metres from its first centre.
    pub states: Vec<NavState>,
}
// ANCHOR_END: inertial_map

// ANCHOR: inertial_map_of
/// The most likely states, scale, direction of gravity and bias, from where the linear equations left
/// them [@campos2020]. The cameras' poses count as measured, each with an error of its own.
/// @campos2020 take them for exact; then the noise of the pictures looks like force, and the
/// scale that makes it smallest is too small.
///
/// `accelerometer_bias` is how large the accelerometer's bias may be on each axis, in m/s².
///
/// # Errors
///
/// An [`AlignmentRefused`].
pub fn inertial_map(
    sensors: &Sensors,
    readings: &[StampedSample],
    motion: &VisualMotion,
    aligned: &Alignment,
    accelerometer_bias: f64,
) -> Result<InertialMap, AlignmentRefused> {
    motion.check()?;
    let sums = intervals(sensors, readings, &motion.nanoseconds, &aligned.bias)?;
    let mut problem = Problem::new();
    let log_scale = problem.add_variable(Vector1::new(aligned.scale.ln()));
    let gravity = problem.add_variable(Gravity(aligned.gravity));
    let bias = problem.add_variable(aligned.bias);
    let mut velocity = aligned.velocity;
    let mut states = Vec::with_capacity(motion.centres.len());
    for (place, rotation) in motion.rotations.iter().enumerate() {
        let lever = rotation * sensors.rig.body_from_camera.translation.vector;
        let centre = motion.centres[place] - motion.centres[0];
        let (world_from_body, position) = (*rotation, aligned.scale * centre - lever);
        let state = problem.add_variable(NavState { world_from_body, velocity, position });
        add_pose(&mut problem, (state, log_scale), sensors, motion, place)?;
        states.push(state);
        if let Some(sums) = sums.get(place) {
            velocity += sums.duration * aligned.gravity + rotation * sums.deltas.velocity;
        }
    }
    for (pair, sums) in states.windows(2).zip(sums) {
        let factor = InertialFactor::new([pair[0], pair[1]], bias, gravity, sums)?;
        problem.add_factor(factor, Kernel::Squared)?;
    }
    let free = f64::INFINITY;
    let sigmas = [free, free, free, accelerometer_bias, accelerometer_bias, accelerometer_bias];
    problem.add_factor(Prior::near(bias, ImuBias::default(), sigmas), Kernel::Squared)?;
    let values = problem.solve(&Options::default())?.values;
    let covariance = problem.covariance(&values)?;
    Ok(InertialMap {
        scale: values[log_scale].x.exp(),
        scale_sigma: covariance.of(log_scale).map_or(f64::NAN, |square| square[(0, 0)].sqrt()),
        gravity: values[gravity].0,
        gravity_covariance: covariance.of(gravity).unwrap_or_default(),
        bias: values[bias],
        states: states.into_iter().map(|key| values[key]).collect(),
    })
}
// ANCHOR_END: inertial_map_of

/// What the pictures say of a state. Six unknowns share the pixels of all landmarks that a camera
/// sees, which gives the size of the errors; the batch that follows knows them better.
fn add_pose(
    problem: &mut Problem,
    (state, log_scale): (Key<NavState>, Key<Vector1<f64>>),
    sensors: &Sensors,
    motion: &VisualMotion,
    place: usize,
) -> Result<(), ProblemError> {
    let body_from_camera = sensors.rig.body_from_camera;
    let centre = motion.centres[place] - motion.centres[0];
    let rotation = motion.rotations[place] * body_from_camera.rotation;
    let sees = |at: &&(usize, _)| at.0 == place;
    let seen = motion.landmarks.values().flat_map(|landmark| &landmark.sightings);
    let share = (3.0 / seen.filter(sees).count().max(3) as f64).sqrt();
    let factor = PoseUpToScale {
        state,
        log_scale,
        map_from_camera: Isometry3::from_parts(centre.into(), rotation),
        body_from_camera,
        inverse_turn: sensors.camera.fx / (share * sensors.pixel_sigma),
        inverse_shift: 1.0 / (share * motion.sigma(sensors)),
    };
    problem.add_factor(factor, Kernel::Squared)?;
    Ok(())
}
