//! Poses of which roll and pitch are known.

use nalgebra::{Isometry3, Matrix3, Matrix4, SMatrix, Vector3, Vector4};

use crate::factors::{GraphPose, LinearizedError};
use crate::filtering::metrics::yaw_towards;
use crate::least_squares::Manifold;
use crate::manifold::so3;

// ANCHOR: upright_pose
/// A pose that an estimator moves in position and yaw alone, in a world whose z axis is vertical. The
/// four numbers of a step are a shift along the axes of the world, in metres, and a turn about its
/// vertical, in radians. Roll and pitch stay: a sensor that feels gravity knows them, and nothing that
/// it measures knows the other four.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UprightPose {
    /// The whole pose.
    pub world_from_body: Isometry3<f64>,
}
// ANCHOR_END: upright_pose

// ANCHOR: upright_step
impl Manifold for UprightPose {
    fn dimension(&self) -> usize {
        4
    }

    fn retract(&self, step: &[f64]) -> Self {
        let turn = so3::exp_quaternion(&Vector3::new(0.0, 0.0, step[3]));
        let position = self.position() + Vector3::from_column_slice(&step[..3]);
        let rotation = turn * self.world_from_body.rotation;
        Self { world_from_body: Isometry3::from_parts(position.into(), rotation) }
    }

    /// Where roll and pitch differ, the turn that comes nearest.
    fn local(&self, to: &Self, step: &mut [f64]) {
        step[..3].copy_from_slice((to.position() - self.position()).as_slice());
        let turn = to.world_from_body.rotation * self.world_from_body.rotation.inverse();
        let undecided = if turn.coords.sum().is_finite() { 0.0 } else { f64::NAN };
        step[3] = yaw_of(&turn.to_rotation_matrix().into_inner()).unwrap_or(undecided);
    }

    fn local_jacobian(&self, _to: &Self, into: &mut [f64]) {
        into.copy_from_slice(Matrix4::identity().as_slice());
    }
}
// ANCHOR_END: upright_step

impl UprightPose {
    /// A pose whose roll and pitch will stay.
    pub fn new(world_from_body: Isometry3<f64>) -> Self {
        Self { world_from_body }
    }

    /// The position in the world, in metres.
    pub fn position(&self) -> Vector3<f64> {
        self.world_from_body.translation.vector
    }

    /// The vertical in the frame of a body.
    pub(super) fn up_in_body(world_from_body: &Isometry3<f64>) -> Vector3<f64> {
        world_from_body.rotation.inverse() * Vector3::z()
    }
}

/// The angle of the turn about the vertical that comes nearest to a rotation, if one does.
fn yaw_of(turn: &Matrix3<f64>) -> Option<f64> {
    yaw_towards(turn, UNDECIDED).map(|yaw| so3::log(&yaw).z)
}

/// Below this the two horizontal axes of a rotation say nothing of a turn about the vertical.
const UNDECIDED: f64 = 1e-9;

/// The error is what the position of the second body differs by from what was measured, in the frame of
/// the first, and the yaw that is left between the rotation of the second and the one that was measured
/// from the first. What a measurement says of roll and pitch does not count. Implements
/// {eq:upright-error}.
impl GraphPose<4> for UprightPose {
    type Measured = Isometry3<f64>;

    fn reach(&self, measured: &Isometry3<f64>) -> Self {
        Self::new(self.world_from_body * measured)
    }

    fn reversed(measured: &Isometry3<f64>) -> Isometry3<f64> {
        measured.inverse()
    }

    fn is_finite(measured: &Isometry3<f64>) -> bool {
        <Isometry3<f64> as GraphPose<6>>::is_finite(measured)
    }

    // ANCHOR: upright_error
    fn error(&self, second: &Self, measured: &Isometry3<f64>) -> Option<Vector4<f64>> {
        let (first, second) = (&self.world_from_body, &second.world_from_body);
        let seen =
            first.rotation.inverse() * (second.translation.vector - first.translation.vector);
        let turn = second.rotation * (first.rotation * measured.rotation).inverse();
        let yaw = yaw_of(&turn.to_rotation_matrix().into_inner())?;
        let shift = seen - measured.translation.vector;
        Some(Vector4::new(shift.x, shift.y, shift.z, yaw))
    }
    // ANCHOR_END: upright_error

    // ANCHOR: upright_slopes
    fn linearized_error(
        &self,
        second: &Self,
        measured: &Isometry3<f64>,
    ) -> Option<LinearizedError<4>> {
        let body_from_world = self.world_from_body.rotation.inverse();
        let apart = second.position() - self.position();
        let mut by_second = SMatrix::<f64, 4, 4>::identity();
        by_second
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(body_from_world.to_rotation_matrix().matrix());
        let mut by_first = -by_second;
        // When the first body turns to the left, the second one goes to the right for it.
        let swept = -(body_from_world * Vector3::z().cross(&apart));
        by_first.fixed_view_mut::<3, 1>(0, 3).copy_from(&swept);
        Some((self.error(second, measured)?, by_first, by_second))
    }
    // ANCHOR_END: upright_slopes
}
