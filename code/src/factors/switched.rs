//! A closed loop that may be wrong.

use nalgebra::{SMatrix, SVector, Vector1};

use super::{BetweenPoses, GraphPose};
use crate::least_squares::{Factor, Key};

// ANCHOR: switched
/// A measurement between two poses with a switch, a number that its residual is multiplied by: the
/// switchable constraint of [@sunderhauf2012], with the identity as switch function.
///
/// A [`Prior`](super::Prior) must hold the switch near one. With its information ξ, the best switch
/// for a residual of squared norm e² is ξ / (ξ + e²), {eq:switch-value}: between zero and one, whatever
/// is on the way there, since the cost is a square in the switch.
#[derive(Debug, Clone)]
pub struct Switched<P: GraphPose<D>, const D: usize> {
    /// The measurement.
    pub measurement: BetweenPoses<P, D>,
    /// The switch.
    pub switch: Key<Vector1<f64>>,
}
// ANCHOR_END: switched

impl<P: GraphPose<D>, const D: usize> Factor<D> for Switched<P, D> {
    type Variables = (P, P, Vector1<f64>);
    type Jacobians = (SMatrix<f64, D, D>, SMatrix<f64, D, D>, SMatrix<f64, D, 1>);

    fn variables(&self) -> (Key<P>, Key<P>, Key<Vector1<f64>>) {
        (self.measurement.first, self.measurement.second, self.switch)
    }

    // ANCHOR: switched_residual
    fn residual(
        &self,
        (first, second, switch): (&P, &P, &Vector1<f64>),
    ) -> Option<SVector<f64, D>> {
        Some(switch.x * self.measurement.residual((first, second))?)
    }

    fn linearize(
        &self,
        (first, second, switch): (&P, &P, &Vector1<f64>),
    ) -> Option<(SVector<f64, D>, Self::Jacobians)> {
        let (residual, (by_first, by_second)) = self.measurement.linearize((first, second))?;
        let jacobians = (switch.x * by_first, switch.x * by_second, residual);
        Some((switch.x * residual, jacobians))
    }
    // ANCHOR_END: switched_residual
}
