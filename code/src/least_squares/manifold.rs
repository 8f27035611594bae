//! What a problem can move.

use nalgebra::{Isometry2, Isometry3, Rotation3, SMatrix, SVector, Vector3, Vector6};

use crate::manifold::{se2, se3, so3};

// ANCHOR: manifold
/// A point that is moved by a small vector.
pub trait Manifold: Clone + Send + Sync + 'static {
    /// How many numbers a step has. It does not change when the point moves.
    fn dimension(&self) -> usize;

    /// The point moved by a step of [`Manifold::dimension`] numbers; a step of zeros leaves it
    /// where it is.
    fn retract(&self, step: &[f64]) -> Self;

    /// Writes the step that leads from this point to another one: the inverse of
    /// [`Manifold::retract`] where that has one.
    fn local(&self, to: &Self, step: &mut [f64]);

    /// Writes the derivative of `self.local(to)` by a step of `to`, at zero, column by column: a
    /// square matrix, and the identity where points are moved by addition.
    fn local_jacobian(&self, to: &Self, into: &mut [f64]);
}
// ANCHOR_END: manifold

// ANCHOR: vector
impl<const N: usize> Manifold for SVector<f64, N> {
    fn dimension(&self) -> usize {
        N
    }

    fn retract(&self, step: &[f64]) -> Self {
        self + SVector::from_column_slice(step)
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice((to - self).as_slice());
    }

    fn local_jacobian(&self, _to: &Self, into: &mut [f64]) {
        into.copy_from_slice(SMatrix::<f64, N, N>::identity().as_slice());
    }
}
// ANCHOR_END: vector

// ANCHOR: rotation
/// Moved on the right, R exp(φ), by a rotation vector in radians.
impl Manifold for Rotation3<f64> {
    fn dimension(&self) -> usize {
        3
    }

    fn retract(&self, step: &[f64]) -> Self {
        so3::retract(self, &Vector3::from_column_slice(step))
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice(so3::local(self, to).as_slice());
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let phi = so3::local(self, to);
        into.copy_from_slice(so3::right_jacobian_inverse(&phi).as_slice());
    }
}

/// Moved on the right, T exp(ξ), by a translation in metres and then a rotation vector in
/// radians.
impl Manifold for Isometry3<f64> {
    fn dimension(&self) -> usize {
        6
    }

    fn retract(&self, step: &[f64]) -> Self {
        se3::retract(self, &Vector6::from_column_slice(step))
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice(se3::local(self, to).as_slice());
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let xi = se3::local(self, to);
        into.copy_from_slice(se3::right_jacobian_inverse(&xi).as_slice());
    }
}
// ANCHOR_END: rotation

/// Moved on the right, T exp(ξ), by a translation in metres and then an angle in radians.
impl Manifold for Isometry2<f64> {
    fn dimension(&self) -> usize {
        3
    }

    fn retract(&self, step: &[f64]) -> Self {
        se2::retract(self, &Vector3::from_column_slice(step))
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice(se2::local(self, to).as_slice());
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let xi = se2::local(self, to);
        into.copy_from_slice(se2::right_jacobian_inverse(&xi).as_slice());
    }
}
