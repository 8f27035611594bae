//! Gravity whose size is known and whose direction is not.

use std::f64::consts::PI;

use nalgebra::{Matrix3x2, Rotation3, Vector2, Vector3};

use crate::least_squares::Manifold;
use crate::manifold::so3;

// ANCHOR: gravity
/// The acceleration of free fall in the world, in m/s², as a variable: its length stays, and it moves
/// on its sphere in two coordinates, in radians.
///
/// A step δ turns it by the rotation vector B δ. The columns of B are orthonormal, and orthogonal to
/// gravity, because a turn about gravity itself changes nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gravity(pub Vector3<f64>);

impl Gravity {
    /// The matrix B. Where nothing falls, there is no direction to turn, and any two axes do.
    pub fn basis(&self) -> Matrix3x2<f64> {
        let along = self.0.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let axis = Vector3::ith(along.map(f64::abs).imin(), 1.0);
        let first = along.cross(&axis).normalize();
        Matrix3x2::from_columns(&[first, along.cross(&first)])
    }

    /// The 3×2 derivative of the vector by a step: −g^ B.
    pub fn by_step(&self) -> Matrix3x2<f64> {
        -so3::hat(&self.0) * self.basis()
    }

    /// The rotation vector of the shortest turn to another direction; to the opposite one, of one of them.
    fn turn_to(&self, to: &Self) -> Vector3<f64> {
        let (sine, cosine) = (self.0.cross(&to.0), self.0.dot(&to.0));
        let length = sine.norm();
        if length > 0.0 {
            sine * (length.atan2(cosine) / length)
        } else if cosine < 0.0 {
            PI * self.basis().column(0)
        } else {
            Vector3::zeros()
        }
    }
}
// ANCHOR_END: gravity

impl Manifold for Gravity {
    fn dimension(&self) -> usize {
        2
    }

    fn retract(&self, step: &[f64]) -> Self {
        let turn = self.basis() * Vector2::from_column_slice(step);
        Self(Rotation3::new(turn) * self.0)
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice(self.basis().tr_mul(&self.turn_to(to)).as_slice());
    }

    /// A small turn of `to` about the axis u of the turn adds to its angle θ, and one across it turns
    /// the axis by θ/sin θ times as much.
    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        let turn = self.turn_to(to);
        let angle = turn.norm();
        let mut jacobian = self.basis().tr_mul(&to.basis());
        if angle > 1e-9 {
            let (axis, from, to_unit) = (turn / angle, self.0.normalize(), to.0.normalize());
            let across = angle / angle.sin() * axis.cross(&from) * axis.cross(&to_unit).transpose();
            jacobian = self.basis().tr_mul(&((axis * axis.transpose() + across) * to.basis()));
        }
        into.copy_from_slice(jacobian.as_slice());
    }
}
