//! What odometry says of two poses.

use nalgebra::{Isometry3, Matrix6, Vector6};

use crate::least_squares::{Factor, Key};
use crate::manifold::se3;

// ANCHOR: relative_pose
/// How the second of two cameras stands to the first one, as odometry measures it. The residual is W
/// times the twist, in the frame of the first camera, from what was measured to what is predicted.
#[derive(Debug, Clone)]
pub struct RelativePose {
    /// `camera_from_world` of the first camera.
    pub first: Key<Isometry3<f64>>,
    /// `camera_from_world` of the second one.
    pub second: Key<Isometry3<f64>>,
    /// What was measured: `second_from_first`.
    pub measured: Isometry3<f64>,
    /// The matrix W, from [`sqrt_information`](crate::least_squares::sqrt_information).
    pub sqrt_information: Matrix6<f64>,
}
// ANCHOR_END: relative_pose

impl Factor<6> for RelativePose {
    type Variables = (Isometry3<f64>, Isometry3<f64>);
    type Jacobians = (Matrix6<f64>, Matrix6<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Isometry3<f64>>) {
        (self.first, self.second)
    }

    // ANCHOR: relative_pose_residual
    fn residual(
        &self,
        (first, second): (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<Vector6<f64>> {
        let second_from_first = second * first.inverse();
        Some(self.sqrt_information * se3::local(&self.measured, &second_from_first))
    }

    fn linearize(
        &self,
        (first, second): (&Isometry3<f64>, &Isometry3<f64>),
    ) -> Option<(Vector6<f64>, Self::Jacobians)> {
        let step = se3::local(&self.measured, &(second * first.inverse()));
        // Both cameras step on the side of the world, which the first one takes to its own frame.
        let by_step = self.sqrt_information * se3::right_jacobian_inverse(&step);
        let by_second = by_step * se3::adjoint(first);
        Some((self.sqrt_information * step, (-by_second, by_second)))
    }
    // ANCHOR_END: relative_pose_residual
}
