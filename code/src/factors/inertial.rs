//! Preintegrated readings by the states at both ends and the bias, and a bias by the one before it.

use nalgebra::{Matrix6, Vector3, Vector6};

use crate::inertial::{ImuBias, ImuNoise, NavState};
use crate::least_squares::{Factor, Key, WhiteningError};
use crate::preintegration::{
    BiasWalk, Matrix9, Matrix9x6, Preintegrated, Vector9, imu_residual, linearize,
};

// ANCHOR: inertial_factor
/// The readings of an interval between two states.
#[derive(Debug, Clone, Copy)]
pub struct InertialFactor {
    first: Key<NavState>,
    bias: Key<ImuBias>,
    second: Key<NavState>,
    preintegrated: Preintegrated,
    gravity: Vector3<f64>,
    sqrt_information: Matrix9,
}
// ANCHOR_END: inertial_factor

impl InertialFactor {
    /// Readings that say how `second` follows from `first`, with the bias that holds in between.
    /// Gravity is that of the world, in m/s². The covariance is factored here, once.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] as [`Preintegrated::sqrt_information`].
    pub fn new(
        [first, second]: [Key<NavState>; 2],
        bias: Key<ImuBias>,
        preintegrated: Preintegrated,
        gravity: Vector3<f64>,
    ) -> Result<Self, WhiteningError> {
        let sqrt_information = preintegrated.sqrt_information()?;
        Ok(Self { first, bias, second, preintegrated, gravity, sqrt_information })
    }
}

// ANCHOR: inertial_linearize
impl Factor<9> for InertialFactor {
    type Variables = (NavState, ImuBias, NavState);
    type Jacobians = (Matrix9, Matrix9x6, Matrix9);

    fn variables(&self) -> (Key<NavState>, Key<ImuBias>, Key<NavState>) {
        (self.first, self.bias, self.second)
    }

    fn residual(&self, (first, bias, second): (&NavState, &ImuBias, &NavState)) -> Option<Vector9> {
        let residual = imu_residual(&self.preintegrated, first, second, &self.gravity, bias);
        Some(self.sqrt_information * residual)
    }

    fn linearize(
        &self,
        (first, bias, second): (&NavState, &ImuBias, &NavState),
    ) -> Option<(Vector9, Self::Jacobians)> {
        let linear = linearize(&self.preintegrated, first, second, &self.gravity, bias)
            .whitened(&self.sqrt_information);
        Some((linear.residual, (linear.by_first, linear.by_bias, linear.by_second)))
    }
}
// ANCHOR_END: inertial_linearize

// ANCHOR: bias_walk_factor
/// The random walk of the biases over an interval.
#[derive(Debug, Clone, Copy)]
pub struct BiasWalkFactor {
    first: Key<ImuBias>,
    second: Key<ImuBias>,
    walk: BiasWalk,
}

impl BiasWalkFactor {
    /// The walk from one bias to the next over `duration` seconds.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] as [`BiasWalk::new`].
    pub fn new(
        [first, second]: [Key<ImuBias>; 2],
        noise: &ImuNoise,
        duration: f64,
    ) -> Result<Self, WhiteningError> {
        Ok(Self { first, second, walk: BiasWalk::new(noise, duration)? })
    }
}

impl Factor<6> for BiasWalkFactor {
    type Variables = (ImuBias, ImuBias);
    type Jacobians = (Matrix6<f64>, Matrix6<f64>);

    fn variables(&self) -> (Key<ImuBias>, Key<ImuBias>) {
        (self.first, self.second)
    }

    fn residual(&self, (first, second): (&ImuBias, &ImuBias)) -> Option<Vector6<f64>> {
        Some(self.walk.linearize(first, second).residual)
    }

    fn linearize(
        &self,
        (first, second): (&ImuBias, &ImuBias),
    ) -> Option<(Vector6<f64>, Self::Jacobians)> {
        let linear = self.walk.linearize(first, second);
        Some((linear.residual, (linear.by_first, linear.by_second)))
    }
}
// ANCHOR_END: bias_walk_factor
