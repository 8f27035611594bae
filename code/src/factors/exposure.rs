//! Where a body was when a picture was taken, later than its state by the time offset.

use nalgebra::{Rotation3, SMatrix, SVector, Vector3};

use crate::inertial::{BodyPose, NavState};
use crate::manifold::so3;

// ANCHOR: exposure
/// How a body goes on from a state to the picture: with the velocity that it had, and with this
/// angular velocity, in its frame, in rad/s.
pub(crate) struct Exposure<'a> {
    pub angular_velocity: &'a Vector3<f64>,
}

impl Exposure<'_> {
    /// By how much the body turns in so many seconds.
    fn turn(&self, seconds: f64) -> Rotation3<f64> {
        if seconds == 0.0 {
            Rotation3::identity()
        } else {
            so3::exp(&(seconds * self.angular_velocity))
        }
    }

    /// The body when the picture was taken.
    pub fn body(&self, state: &NavState, offset: f64) -> BodyPose {
        BodyPose {
            world_from_body: state.world_from_body * self.turn(offset),
            position: state.position + offset * state.velocity,
        }
    }
    // ANCHOR_END: exposure

    // ANCHOR: carry
    /// The derivatives of something, as a pixel, by a step of the state and by the time offset, from those
    /// by a step (φ, p) of the body when the picture was taken: φ is carried along by the turn in
    /// between, and p by the velocity. By the time offset it moves as by the velocities that the body has.
    pub fn carry<const R: usize>(
        &self,
        by_body: &SMatrix<f64, R, 6>,
        state: &NavState,
        offset: f64,
    ) -> (SMatrix<f64, R, 9>, SVector<f64, R>) {
        let (by_turn, by_shift) = (by_body.fixed_columns::<3>(0), by_body.fixed_columns::<3>(3));
        let mut by_state = SMatrix::<f64, R, 9>::zeros();
        let carried = by_turn * self.turn(offset).matrix().transpose();
        by_state.fixed_columns_mut::<3>(0).copy_from(&carried);
        by_state.fixed_columns_mut::<3>(3).copy_from(&(offset * by_shift));
        by_state.fixed_columns_mut::<3>(6).copy_from(&by_shift);
        (by_state, by_turn * self.angular_velocity + by_shift * state.velocity)
    }
    // ANCHOR_END: carry
}
