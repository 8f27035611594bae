//! Where a body is, how it is turned and how fast it goes.

use nalgebra::{Isometry3, Rotation3, SMatrix, Vector3};

use super::ImuSample;
use crate::least_squares::Manifold;
use crate::manifold::so3;

/// The acceleration of free fall, in the world, in m/s².
pub const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

// ANCHOR: state
/// The navigation state of a body. A step of it has nine numbers (φ, v, p): the rotation moves
/// on the right, R exp(φ), velocity and position by addition, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavState {
    /// The rotation that takes body coordinates to world coordinates.
    pub world_from_body: Rotation3<f64>,
    /// Velocity in the world, in m/s.
    pub velocity: Vector3<f64>,
    /// Position in the world, in metres.
    pub position: Vector3<f64>,
}

impl Manifold for NavState {
    fn dimension(&self) -> usize {
        9
    }

    fn retract(&self, step: &[f64]) -> Self {
        Self {
            world_from_body: self.world_from_body.retract(&step[0..3]),
            velocity: self.velocity + Vector3::from_column_slice(&step[3..6]),
            position: self.position + Vector3::from_column_slice(&step[6..9]),
        }
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        self.world_from_body.local(&to.world_from_body, &mut step[0..3]);
        step[3..6].copy_from_slice((to.velocity - self.velocity).as_slice());
        step[6..9].copy_from_slice((to.position - self.position).as_slice());
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let mut jacobian = SMatrix::<f64, 9, 9>::identity();
        let phi = so3::local(&self.world_from_body, &to.world_from_body);
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::right_jacobian_inverse(&phi));
        into.copy_from_slice(jacobian.as_slice());
    }
}
// ANCHOR_END: state

impl NavState {
    /// At the origin of the world, at rest, with the axes of the world.
    pub fn origin() -> Self {
        Self {
            world_from_body: Rotation3::identity(),
            velocity: Vector3::zeros(),
            position: Vector3::zeros(),
        }
    }

    /// The pose of the body: `world_from_body` with the position, as an isometry that takes body
    /// coordinates to world coordinates.
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(self.position.into(), self.world_from_body.into())
    }

    // ANCHOR: propagate
    /// The state `dt` seconds on, by the Euler rule: the reading, free of bias, holds for the
    /// whole step, and its force acts in the direction the body has at the beginning.
    /// Implements {eq:inertial-euler-rule}.
    pub fn propagate(&self, sample: &ImuSample, gravity: &Vector3<f64>, dt: f64) -> Self {
        let along = self.world_from_body;
        self.advance(&along, sample, gravity, dt)
    }

    /// The state `dt` seconds on, by the midpoint rule: the mean of the readings at the two ends
    /// holds for the step, and its force acts in the direction the body has halfway.
    /// Implements {eq:inertial-midpoint-rule}.
    pub fn propagate_midpoint(
        &self,
        start: &ImuSample,
        end: &ImuSample,
        gravity: &Vector3<f64>,
        dt: f64,
    ) -> Self {
        let mean = ImuSample::mean(start, end);
        let halfway = so3::retract(&self.world_from_body, &(0.5 * dt * mean.gyro));
        self.advance(&halfway, &mean, gravity, dt)
    }
    // ANCHOR_END: propagate

    // ANCHOR: advance
    /// One step in which the force is turned into the world by `along`. Each line reads the
    /// state before the step, so that {eq:inertial-first-state} holds exactly.
    fn advance(
        &self,
        along: &Rotation3<f64>,
        sample: &ImuSample,
        gravity: &Vector3<f64>,
        dt: f64,
    ) -> Self {
        let acceleration = gravity + along * sample.accelerometer;
        Self {
            position: self.position + dt * self.velocity + 0.5 * dt * dt * acceleration,
            velocity: self.velocity + dt * acceleration,
            world_from_body: so3::retract(&self.world_from_body, &(dt * sample.gyro)),
        }
    }
    // ANCHOR_END: advance
}

// ANCHOR: body_pose
/// A state without its velocity: where a body was when a picture was taken. A step of it has six
/// numbers (φ, p), moved as those of a [`NavState`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyPose {
    /// The rotation that takes body coordinates to world coordinates.
    pub world_from_body: Rotation3<f64>,
    /// Position in the world, in metres.
    pub position: Vector3<f64>,
}

impl BodyPose {
    /// A state there, at rest.
    pub fn at_rest(&self) -> NavState {
        let Self { world_from_body, position } = *self;
        NavState { world_from_body, velocity: Vector3::zeros(), position }
    }
}

impl From<&NavState> for BodyPose {
    fn from(state: &NavState) -> Self {
        Self { world_from_body: state.world_from_body, position: state.position }
    }
}

impl Manifold for BodyPose {
    fn dimension(&self) -> usize {
        6
    }

    fn retract(&self, step: &[f64]) -> Self {
        Self {
            world_from_body: self.world_from_body.retract(&step[0..3]),
            position: self.position + Vector3::from_column_slice(&step[3..6]),
        }
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        self.world_from_body.local(&to.world_from_body, &mut step[0..3]);
        step[3..6].copy_from_slice((to.position - self.position).as_slice());
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let mut jacobian = SMatrix::<f64, 6, 6>::identity();
        let phi = so3::local(&self.world_from_body, &to.world_from_body);
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::right_jacobian_inverse(&phi));
        into.copy_from_slice(jacobian.as_slice());
    }
}
// ANCHOR_END: body_pose
