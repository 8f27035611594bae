//! A camera beside an inertial measurement unit.

use nalgebra::{Isometry3, Vector3, Vector6};

use super::NavState;
use crate::manifold::se3;

// ANCHOR: camera_imu
/// How a camera sits on the body and how its clock goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraImu {
    /// Takes camera coordinates to body coordinates. Its translation is the lever arm, from the
    /// inertial sensor to the camera, in metres in the body frame.
    pub body_from_camera: Isometry3<f64>,
    /// What to add to a time of the camera's clock to get that of the sensor's, in seconds.
    pub time_offset: f64,
}
// ANCHOR_END: camera_imu

/// What of that is estimated, and how uncertain it is at the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Calibrated {
    /// The standard deviations of `body_from_camera` as its retraction counts it: of its
    /// translation in metres and of its rotation in radians. `None` when it is known.
    pub extrinsics: Option<[f64; 2]>,
    /// The standard deviation of the time offset, in seconds. `None` when it is known. A filter
    /// estimates it through the poses of its window, {eq:clone-clock}, as @li2014 do.
    pub time_offset: Option<f64>,
}

impl CameraImu {
    // ANCHOR: camera_pose
    /// The transform that takes world coordinates to camera coordinates.
    pub fn camera_from_world(&self, state: &NavState) -> Isometry3<f64> {
        self.world_from_camera(state).inverse()
    }

    /// The pose of the camera, T_wb T_bc. Its translation is the camera's centre p + R l, for
    /// the lever arm l.
    pub fn world_from_camera(&self, state: &NavState) -> Isometry3<f64> {
        state.pose() * self.body_from_camera
    }
    // ANCHOR_END: camera_pose

    // ANCHOR: camera_twist
    /// The velocity of the camera as a twist (ρ, ω) in its own frame, in m/s and rad/s. A body
    /// that turns swings the camera about on its lever arm: ρ is {eq:inertial-camera-velocity}
    /// in the camera. `angular_velocity` is that of the body, in its frame, in rad/s.
    pub fn twist(&self, state: &NavState, angular_velocity: &Vector3<f64>) -> Vector6<f64> {
        let lever = self.body_from_camera.translation.vector;
        let velocity = state.world_from_body.inverse() * state.velocity;
        let camera_from_body = self.body_from_camera.rotation.inverse();
        let rho = camera_from_body * (velocity + angular_velocity.cross(&lever));
        let omega = camera_from_body * angular_velocity;
        Vector6::new(rho.x, rho.y, rho.z, omega.x, omega.y, omega.z)
    }

    /// The pose of the camera when its clock shows the time that the sensor's clock showed at
    /// `state`: it has moved on with its twist. Implements {eq:inertial-time-offset}.
    pub fn world_from_camera_at_same_reading(
        &self,
        state: &NavState,
        angular_velocity: &Vector3<f64>,
    ) -> Isometry3<f64> {
        let moved = self.time_offset * self.twist(state, angular_velocity);
        se3::retract(&self.world_from_camera(state), &moved)
    }
    // ANCHOR_END: camera_twist

    /// Time on the sensor's clock of a time on the camera's, both in nanoseconds.
    pub fn imu_nanoseconds(&self, camera_nanoseconds: i64) -> i64 {
        camera_nanoseconds.saturating_add(self.offset_nanoseconds())
    }

    /// Time on the camera's clock of a time on the sensor's, both in nanoseconds.
    pub fn camera_nanoseconds(&self, imu_nanoseconds: i64) -> i64 {
        imu_nanoseconds.saturating_sub(self.offset_nanoseconds())
    }

    fn offset_nanoseconds(&self) -> i64 {
        (1e9 * self.time_offset).round() as i64
    }

    // ANCHOR: lever_arm
    /// The acceleration at the camera, in the body frame, of a body that accelerates and turns:
    /// besides that of the body α × l + ω × (ω × l), for the lever arm l. Implements
    /// {eq:inertial-camera-acceleration}.
    ///
    /// `acceleration` in m/s², `angular_velocity` in rad/s and `angular_acceleration` in rad/s²,
    /// all in the body frame.
    pub fn acceleration(
        &self,
        acceleration: &Vector3<f64>,
        angular_velocity: &Vector3<f64>,
        angular_acceleration: &Vector3<f64>,
    ) -> Vector3<f64> {
        let lever = self.body_from_camera.translation.vector;
        let inward = angular_velocity.cross(&angular_velocity.cross(&lever));
        acceleration + angular_acceleration.cross(&lever) + inward
    }
    // ANCHOR_END: lever_arm
}
