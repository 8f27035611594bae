//! What is known of one variable beforehand.

use nalgebra::{SMatrix, SVector};

use crate::least_squares::{Factor, Key, Manifold};

// ANCHOR: prior
/// A variable of `N` coordinates that lies near an anchor. The residual is W times the step that
/// leads from the anchor to the variable, with Wᵀ W the inverse of the covariance of that step.
#[derive(Debug, Clone)]
pub struct Prior<V, const N: usize> {
    /// The variable.
    pub variable: Key<V>,
    /// Where it is expected.
    pub anchor: V,
    /// The matrix W, from [`sqrt_information`](crate::least_squares::sqrt_information).
    pub sqrt_information: SMatrix<f64, N, N>,
}

impl<V: Manifold, const N: usize> Prior<V, N> {
    /// A variable whose coordinates are known with these standard deviations, independently. An infinite
    /// one says nothing.
    pub fn near(variable: Key<V>, anchor: V, sigmas: [f64; N]) -> Self {
        let sqrt_information = SMatrix::from_diagonal(&SVector::from(sigmas).map(f64::recip));
        Self { variable, anchor, sqrt_information }
    }
}

impl<V: Manifold, const N: usize> Factor<N> for Prior<V, N> {
    type Variables = (V,);
    type Jacobians = (SMatrix<f64, N, N>,);

    fn variables(&self) -> (Key<V>,) {
        (self.variable,)
    }

    fn residual(&self, (value,): (&V,)) -> Option<SVector<f64, N>> {
        let mut step = SVector::<f64, N>::zeros();
        self.anchor.local(value, step.as_mut_slice());
        Some(self.sqrt_information * step)
    }

    fn linearize(&self, (value,): (&V,)) -> Option<(SVector<f64, N>, Self::Jacobians)> {
        let mut by_step = SMatrix::<f64, N, N>::zeros();
        self.anchor.local_jacobian(value, by_step.as_mut_slice());
        Some((self.residual((value,))?, (self.sqrt_information * by_step,)))
    }
}
// ANCHOR_END: prior
