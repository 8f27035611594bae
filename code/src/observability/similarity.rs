//! Moving, turning and growing a whole window.

use std::iter;

use nalgebra::{Rotation3, Vector3};

use super::Window;
use crate::filtering::yaw_towards;
use crate::inertial::NavState;

// ANCHOR: similarity
/// A motion of the whole world with a change of its size: a point P goes to s Θ P + t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// The factor s by which lengths grow.
    pub scale: f64,
    /// The rotation Θ.
    pub rotation: Rotation3<f64>,
    /// The shift t, in metres.
    pub translation: Vector3<f64>,
}
// ANCHOR_END: similarity

impl Similarity {
    /// The one that changes nothing.
    pub fn identity() -> Self {
        Self { scale: 1.0, rotation: Rotation3::identity(), translation: Vector3::zeros() }
    }

    /// The turn about the vertical that brings the attitude of a state nearest to that of another one, and the shift
    /// that takes one position to the other: what camera and inertial sensor leave open.
    pub fn between(from: &NavState, to: &NavState) -> Self {
        let turned = to.world_from_body * from.world_from_body.inverse();
        let rotation = yaw_towards(turned.matrix(), 0.0).unwrap_or_else(Rotation3::identity);
        let translation = to.position - rotation * from.position;
        Self { scale: 1.0, rotation, translation }
    }

    /// A point of the world after it.
    pub fn point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.scale * (self.rotation * point) + self.translation
    }

    // ANCHOR: moved_state
    /// A state after it, with the camera's centre `lever` metres from the body in its frame. It is
    /// the camera's path that grows; the lever arm is made of metal and does not.
    ///
    /// Implements {eq:moved-state}. `angular_velocity` is the body's, in its frame, in rad/s.
    pub fn state(
        &self,
        state: &NavState,
        lever: &Vector3<f64>,
        angular_velocity: &Vector3<f64>,
    ) -> NavState {
        let growth = self.scale - 1.0;
        let arm = state.world_from_body * lever;
        let swing = state.world_from_body * angular_velocity.cross(lever);
        NavState {
            world_from_body: self.rotation * state.world_from_body,
            velocity: self.rotation * (self.scale * state.velocity + growth * swing),
            position: self.point(&state.position) + growth * (self.rotation * arm),
        }
    }
    // ANCHOR_END: moved_state
}

impl Window {
    // ANCHOR: transformed
    /// The window after a similarity, with the same measurements. The accelerometer's bias is left as it
    /// is when it is known. Otherwise it changes so as to hide what it can, by the mean of
    /// {eq:hidden-by-bias} over the intervals.
    pub fn transformed(&self, similarity: &Similarity) -> Self {
        let mut moved = self.clone();
        let lever = &self.rig.body_from_camera.translation.vector;
        for (state, rate) in moved.states.iter_mut().zip(self.rates()) {
            *state = similarity.state(state, lever, &rate);
        }
        for landmark in &mut moved.landmarks {
            *landmark = similarity.point(landmark);
        }
        if !self.assumption.accelerometer_known {
            let unturned = similarity.rotation.inverse() * self.gravity;
            let change = self.hiding_bias(similarity.scale - 1.0, &(self.gravity - unturned));
            for bias in &mut moved.biases {
                bias.accelerometer += change;
            }
        }
        moved
    }
    // ANCHOR_END: transformed

    /// How fast the body turns at each state, in its own frame and rad/s; zero where nobody has said it.
    pub(super) fn rates(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.angular_velocities.iter().copied().chain(iter::repeat(Vector3::zeros()))
    }

    /// The velocity of the camera at a state, in the world, in m/s.
    pub(super) fn camera_velocity(&self, state: usize) -> Vector3<f64> {
        let NavState { world_from_body, velocity, .. } = &self.states[state];
        let lever = &self.rig.body_from_camera.translation.vector;
        let rate = self.angular_velocities.get(state).copied().unwrap_or_default();
        velocity + world_from_body * rate.cross(lever)
    }

    // ANCHOR: hiding_bias
    /// The change of the accelerometer's bias that hides best, in the mean over the intervals, when
    /// the camera's velocities change in proportion to `scale` and gravity, seen from the states,
    /// is off by `tilt`, in m/s². Zero without readings.
    pub(super) fn hiding_bias(&self, scale: f64, tilt: &Vector3<f64>) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        let velocity = |state| self.camera_velocity(state);
        for (i, (pair, interval)) in self.states.windows(2).zip(&self.intervals).enumerate() {
            let stated = scale * (velocity(i + 1) - velocity(i)) + interval.duration * tilt;
            let in_body = pair[0].world_from_body.inverse() * stated;
            // What a bias adds to the sum of velocities: minus the sum of the rotations, times dt.
            let by_bias = interval.bias_jacobian.fixed_view::<3, 3>(3, 3).into_owned();
            sum += by_bias.lu().solve(&in_body).unwrap_or_default();
        }
        sum / self.intervals.len().max(1) as f64
    }
    // ANCHOR_END: hiding_bias
}
