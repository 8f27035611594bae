//! Motions that hide their scale, by name.

use nalgebra::{DMatrix, Vector3};

use super::{Sensors, UniformMotion, VisualMotion};
use crate::filtering::chi_square_quantile;

/// What is left of the centres of a uniform motion stays below this with that probability.
const PROBABILITY: f64 = 0.999;

impl VisualMotion {
    // ANCHOR: uniform
    /// The motion's name, if its centres lie on a line or a parabola over time as well as they are
    /// known. Lists that do not belong together have none.
    pub fn uniform(&self, sensors: &Sensors) -> Option<UniformMotion> {
        self.check().ok()?;
        let fits = |degree: usize| {
            let degrees = 3 * self.centres.len().saturating_sub(degree + 1);
            let limit = chi_square_quantile(PROBABILITY, degrees).ok()?;
            let left = self.left_of_polynomial(degree)? / self.sigma(sensors).powi(2);
            Some(degrees > 0 && left < limit)
        };
        if fits(1)? {
            Some(UniformMotion::ConstantVelocity)
        } else {
            fits(2)?.then_some(UniformMotion::ConstantAcceleration)
        }
    }
    // ANCHOR_END: uniform

    /// The sum of the squares that a polynomial of this degree over time leaves of the centres.
    fn left_of_polynomial(&self, degree: usize) -> Option<f64> {
        let (count, whole) = (self.centres.len(), self.seconds(self.centres.len().checked_sub(1)?));
        let power = |row: usize, column: usize| (self.seconds(row) / whole).powi(column as i32);
        let powers = DMatrix::from_fn(count, degree + 1, power);
        let centres = DMatrix::from_fn(count, 3, |row, axis| self.centres[row][axis]);
        let fit = (powers.tr_mul(&powers)).cholesky()?.solve(&powers.tr_mul(&centres));
        let left = centres - powers * fit;
        Some(left.row_iter().map(|row| Vector3::new(row[0], row[1], row[2]).norm_squared()).sum())
    }
}
