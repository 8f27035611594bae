//! A camera's pose that pictures alone have found, by the state of the body and the unknown scale.

use nalgebra::{Isometry3, SMatrix, Vector1, Vector3, Vector6};

use crate::inertial::NavState;
use crate::least_squares::{Factor, Key};
use crate::manifold::so3;

// ANCHOR: pose_up_to_scale
/// A camera's pose in a map whose unit of length is not known. The map and the states share the
/// axes and the origin. Implements {eq:pose-up-to-scale}.
#[derive(Debug, Clone, Copy)]
pub struct PoseUpToScale {
    /// The body when the picture was taken.
    pub state: Key<NavState>,
    /// The logarithm of the metres in a unit of the map.
    pub log_scale: Key<Vector1<f64>>,
    /// The camera's pose, `map_from_camera`, in the unit of the map.
    pub map_from_camera: Isometry3<f64>,
    /// How the camera sits on the body, in metres.
    pub body_from_camera: Isometry3<f64>,
    /// One over the standard deviation of a turn about each axis, in 1/rad.
    pub inverse_turn: f64,
    /// One over that of the camera's centre along each axis, in the map's unit.
    pub inverse_shift: f64,
}
// ANCHOR_END: pose_up_to_scale

impl PoseUpToScale {
    /// How the state's rotation differs from that of the picture, as a turn of the body.
    fn turn(&self, state: &NavState) -> Vector3<f64> {
        let camera_from_body = self.body_from_camera.rotation.inverse();
        let seen = (self.map_from_camera.rotation * camera_from_body).to_rotation_matrix();
        so3::log(&(seen.inverse() * state.world_from_body))
    }

    /// Where the state has the camera's centre, in the map's unit.
    fn centre(&self, state: &NavState, log_scale: f64) -> Vector3<f64> {
        let lever = self.body_from_camera.translation.vector;
        (-log_scale).exp() * (state.position + state.world_from_body * lever)
    }
}

impl Factor<6> for PoseUpToScale {
    type Variables = (NavState, Vector1<f64>);
    type Jacobians = (SMatrix<f64, 6, 9>, Vector6<f64>);

    fn variables(&self) -> (Key<NavState>, Key<Vector1<f64>>) {
        (self.state, self.log_scale)
    }

    fn residual(&self, (state, log_scale): (&NavState, &Vector1<f64>)) -> Option<Vector6<f64>> {
        let shift = self.centre(state, log_scale.x) - self.map_from_camera.translation.vector;
        let (turn, shift) = (self.inverse_turn * self.turn(state), self.inverse_shift * shift);
        Some(Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z))
    }

    // ANCHOR: pose_up_to_scale_linearize
    fn linearize(
        &self,
        (state, log_scale): (&NavState, &Vector1<f64>),
    ) -> Option<(Vector6<f64>, Self::Jacobians)> {
        let rotation = state.world_from_body.matrix();
        let lever = self.body_from_camera.translation.vector;
        let units = self.inverse_shift * (-log_scale.x).exp();
        let mut by_state = SMatrix::<f64, 6, 9>::zeros();
        let by_turn = self.inverse_turn * so3::right_jacobian_inverse(&self.turn(state));
        by_state.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_turn);
        by_state.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-units * rotation * so3::hat(&lever)));
        by_state.fixed_view_mut::<3, 3>(3, 6).fill_diagonal(units);
        let mut by_scale = Vector6::zeros();
        let centre = self.centre(state, log_scale.x);
        by_scale.fixed_rows_mut::<3>(3).copy_from(&(-self.inverse_shift * centre));
        Some((self.residual((state, log_scale))?, (by_state, by_scale)))
    }
    // ANCHOR_END: pose_up_to_scale_linearize
}
