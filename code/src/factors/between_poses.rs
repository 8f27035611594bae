//! What odometry, or a closed loop, says of two poses of a body.

use std::fmt::Debug;

use nalgebra::{Isometry2, Isometry3, SMatrix, SVector};

use crate::least_squares::{Factor, Key, Manifold};
use crate::manifold::{se2, se3};

// ANCHOR: graph_pose
/// A pose of a pose graph, `world_from_body`, with `D` degrees of freedom, and what it means that
/// another pose was measured from it.
pub trait GraphPose<const D: usize>: Manifold {
    /// What is measured: `first_from_second`.
    type Measured: Clone + Debug + Send + Sync + 'static;

    /// Where the second pose is if this is the first one and the measurement is right.
    fn reach(&self, measured: &Self::Measured) -> Self;

    /// The measurement as the second pose would have made it: `second_from_first`.
    fn reversed(measured: &Self::Measured) -> Self::Measured;

    /// Whether all numbers of a measurement are finite.
    fn is_finite(measured: &Self::Measured) -> bool;

    /// The step from what was measured to what the two poses predict, not whitened, or `None` where
    /// it has no value.
    fn error(&self, second: &Self, measured: &Self::Measured) -> Option<SVector<f64, D>>;

    /// That step, and its derivatives by a step of the first and of the second pose.
    fn linearized_error(
        &self,
        second: &Self,
        measured: &Self::Measured,
    ) -> Option<LinearizedError<D>>;
}
// ANCHOR_END: graph_pose

/// An error, and its derivatives by a step of the first and of the second pose.
pub type LinearizedError<const D: usize> =
    (SVector<f64, D>, SMatrix<f64, D, D>, SMatrix<f64, D, D>);

// ANCHOR: between_poses
/// How the second of two poses of a body stands to the first one. The residual is W times the step
/// from what was measured to what is predicted.
///
/// [`RelativePose`](super::RelativePose) says the same of cameras, whose poses are
/// `camera_from_world` and step on the side of the world. A trajectory of a mile wants steps in the
/// frame of the body: there a small turn moves nothing else.
#[derive(Debug, Clone)]
pub struct BetweenPoses<P: GraphPose<D>, const D: usize> {
    /// `world_from_body` of the first pose.
    pub first: Key<P>,
    /// `world_from_body` of the second one.
    pub second: Key<P>,
    /// What was measured: `first_from_second`.
    pub measured: P::Measured,
    /// A matrix W with Wᵀ W the information of the measurement.
    pub sqrt_information: SMatrix<f64, D, D>,
}
// ANCHOR_END: between_poses

impl<P: GraphPose<D>, const D: usize> Factor<D> for BetweenPoses<P, D> {
    type Variables = (P, P);
    type Jacobians = (SMatrix<f64, D, D>, SMatrix<f64, D, D>);

    fn variables(&self) -> (Key<P>, Key<P>) {
        (self.first, self.second)
    }

    // ANCHOR: between_residual
    fn residual(&self, (first, second): (&P, &P)) -> Option<SVector<f64, D>> {
        Some(self.sqrt_information * first.error(second, &self.measured)?)
    }

    fn linearize(&self, (first, second): (&P, &P)) -> Option<(SVector<f64, D>, Self::Jacobians)> {
        let w = &self.sqrt_information;
        let (error, by_first, by_second) = first.linearized_error(second, &self.measured)?;
        Some((w * error, (w * by_first, w * by_second)))
    }
    // ANCHOR_END: between_residual
}

/// In space the error is the twist log(Z⁻¹ T₁⁻¹ T₂), with Z what was measured: translation first, in
/// the frame of the second pose. Implements {eq:loop-error} and {eq:loop-slopes}.
impl GraphPose<6> for Isometry3<f64> {
    type Measured = Self;

    fn reach(&self, measured: &Self) -> Self {
        self * measured
    }

    fn reversed(measured: &Self) -> Self {
        measured.inverse()
    }

    fn is_finite(measured: &Self) -> bool {
        measured.to_homogeneous().iter().all(|number| number.is_finite())
    }

    // ANCHOR: between_spatial
    fn error(&self, second: &Self, measured: &Self) -> Option<SVector<f64, 6>> {
        Some(se3::local(measured, &self.inv_mul(second)))
    }

    fn linearized_error(&self, second: &Self, measured: &Self) -> Option<LinearizedError<6>> {
        let first_from_second = self.inv_mul(second);
        let error = se3::local(measured, &first_from_second);
        let by_second = se3::right_jacobian_inverse(&error);
        // A step of the first pose is one of the second, seen from there, with the other sign.
        let by_first = -by_second * se3::adjoint(&first_from_second.inverse());
        Some((error, by_first, by_second))
    }
    // ANCHOR_END: between_spatial
}

/// In the plane the error is the twist log(Z⁻¹ T₁⁻¹ T₂), translation first.
impl GraphPose<3> for Isometry2<f64> {
    type Measured = Self;

    fn reach(&self, measured: &Self) -> Self {
        self * measured
    }

    fn reversed(measured: &Self) -> Self {
        measured.inverse()
    }

    fn is_finite(measured: &Self) -> bool {
        measured.to_homogeneous().iter().all(|number| number.is_finite())
    }

    fn error(&self, second: &Self, measured: &Self) -> Option<SVector<f64, 3>> {
        Some(se2::local(measured, &self.inv_mul(second)))
    }

    fn linearized_error(&self, second: &Self, measured: &Self) -> Option<LinearizedError<3>> {
        let first_from_second = self.inv_mul(second);
        let error = se2::local(measured, &first_from_second);
        let by_second = se2::right_jacobian_inverse(&error);
        let by_first = -by_second * se2::adjoint(&first_from_second.inverse());
        Some((error, by_first, by_second))
    }
}
