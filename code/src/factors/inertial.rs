//! Preintegrated readings by the states at both ends and the bias, a bias by the one before it, and
//! both in one when they are correlated.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

use crate::inertial::{AxisNoise, Gravity, ImuBias, NavState};
use crate::least_squares::{Factor, Key, WhiteningError};
use crate::preintegration::{
    BiasWalk, CombinedPreintegrated, Matrix9, Matrix9x6, Matrix15, Preintegrated, Vector9,
    by_gravity, imu_residual, linearize,
};

// ANCHOR: inertial_factor
/// The readings of an interval between two states.
#[derive(Debug, Clone, Copy)]
pub struct InertialFactor {
    first: Key<NavState>,
    bias: Key<ImuBias>,
    second: Key<NavState>,
    gravity: Key<Gravity>,
    preintegrated: Preintegrated,
    sqrt_information: Matrix9,
}
// ANCHOR_END: inertial_factor

impl InertialFactor {
    /// Readings that say how `second` follows from `first`, with the bias that holds in between.
    /// Gravity is that of the world; where it is known, it is held. The covariance is factored here,
    /// once.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] as [`Preintegrated::sqrt_information`].
    pub fn new(
        [first, second]: [Key<NavState>; 2],
        bias: Key<ImuBias>,
        gravity: Key<Gravity>,
        preintegrated: Preintegrated,
    ) -> Result<Self, WhiteningError> {
        let sqrt_information = preintegrated.sqrt_information()?;
        Ok(Self { first, bias, second, gravity, preintegrated, sqrt_information })
    }
}

/// Values of the variables of an [`InertialFactor`].
type Interval<'a> = (&'a NavState, &'a ImuBias, &'a NavState, &'a Gravity);

// ANCHOR: inertial_linearize
impl Factor<9> for InertialFactor {
    type Variables = (NavState, ImuBias, NavState, Gravity);
    type Jacobians = (Matrix9, Matrix9x6, Matrix9, SMatrix<f64, 9, 2>);

    fn variables(&self) -> (Key<NavState>, Key<ImuBias>, Key<NavState>, Key<Gravity>) {
        (self.first, self.bias, self.second, self.gravity)
    }

    fn residual(&self, (first, bias, second, gravity): Interval) -> Option<Vector9> {
        let residual = imu_residual(&self.preintegrated, first, second, &gravity.0, bias);
        Some(self.sqrt_information * residual)
    }

    fn linearize(
        &self,
        (first, bias, second, gravity): Interval,
    ) -> Option<(Vector9, Self::Jacobians)> {
        let linear = linearize(&self.preintegrated, first, second, &gravity.0, bias)
            .whitened(&self.sqrt_information);
        let by_gravity = by_gravity(self.preintegrated.duration, first) * gravity.by_step();
        let by_gravity = self.sqrt_information * by_gravity;
        Some((linear.residual, (linear.by_first, linear.by_bias, linear.by_second, by_gravity)))
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
        noise: impl Into<AxisNoise>,
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

/// The readings of an interval in which the bias walks, between two states with a bias each. The
/// residual is that of [`InertialFactor`] at the first bias, then that of [`BiasWalkFactor`], and
/// whitened together. Those two are its special case without covariance between them.
#[derive(Debug, Clone, Copy)]
pub struct CombinedInertialFactor {
    states: [Key<NavState>; 2],
    biases: [Key<ImuBias>; 2],
    gravity: Key<Gravity>,
    sums: Preintegrated,
    sqrt_information: Matrix15,
}

impl CombinedInertialFactor {
    /// Readings that say how the second state follows from the first, and how far the second bias
    /// may be from the first. Gravity is that of the world; where it is known, it is held. The
    /// covariance is factored here, once.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] as [`CombinedPreintegrated::sqrt_information`].
    pub fn new(
        states: [Key<NavState>; 2],
        biases: [Key<ImuBias>; 2],
        gravity: Key<Gravity>,
        preintegrated: &CombinedPreintegrated,
    ) -> Result<Self, WhiteningError> {
        let sqrt_information = preintegrated.sqrt_information()?;
        Ok(Self { states, biases, gravity, sums: preintegrated.sums, sqrt_information })
    }

    /// Whitens what the deltas and the walk of the bias say.
    fn whitened<const N: usize>(
        &self,
        deltas: &SMatrix<f64, 9, N>,
        walk: &SMatrix<f64, 6, N>,
    ) -> SMatrix<f64, 15, N> {
        self.sqrt_information.fixed_columns::<9>(0) * deltas
            + self.sqrt_information.fixed_columns::<6>(9) * walk
    }
}

/// Values of the variables of a [`CombinedInertialFactor`].
type Walked<'a> = (&'a NavState, &'a ImuBias, &'a NavState, &'a ImuBias, &'a Gravity);

impl Factor<15> for CombinedInertialFactor {
    type Variables = (NavState, ImuBias, NavState, ImuBias, Gravity);
    type Jacobians = (
        SMatrix<f64, 15, 9>,
        SMatrix<f64, 15, 6>,
        SMatrix<f64, 15, 9>,
        SMatrix<f64, 15, 6>,
        SMatrix<f64, 15, 2>,
    );

    fn variables(
        &self,
    ) -> (Key<NavState>, Key<ImuBias>, Key<NavState>, Key<ImuBias>, Key<Gravity>) {
        (self.states[0], self.biases[0], self.states[1], self.biases[1], self.gravity)
    }

    fn residual(&self, (first, bias, second, later, gravity): Walked) -> Option<SVector<f64, 15>> {
        let deltas = imu_residual(&self.sums, first, second, &gravity.0, bias);
        Some(self.whitened(&deltas, &(later.vector() - bias.vector())))
    }

    fn linearize(
        &self,
        (first, bias, second, later, gravity): Walked,
    ) -> Option<(SVector<f64, 15>, Self::Jacobians)> {
        let linear = linearize(&self.sums, first, second, &gravity.0, bias);
        let walk = later.vector() - bias.vector();
        let by_first = self.whitened(&linear.by_first, &SMatrix::zeros());
        let by_bias = self.whitened(&linear.by_bias, &-Matrix6::identity());
        let by_second = self.whitened(&linear.by_second, &SMatrix::zeros());
        let by_later = self.whitened(&SMatrix::zeros(), &Matrix6::identity());
        let by_gravity = by_gravity(self.sums.duration, first) * gravity.by_step();
        let by_gravity = self.whitened(&by_gravity, &SMatrix::zeros());
        let residual = self.whitened(&linear.residual, &walk);
        Some((residual, (by_first, by_bias, by_second, by_later, by_gravity)))
    }
}
