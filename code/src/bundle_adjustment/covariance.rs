//! How well cameras and points are known.

use nalgebra::{DMatrix, Matrix3, SMatrix};

use super::{BaError, Camera, Solver};

// ANCHOR: covariance
/// Covariances of cameras and points, to first order, for noise of the standard deviations
/// that the observations state.
///
/// What is held has no covariance: all of it is relative to the gauge.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance<const D: usize> {
    /// The inverse of the reduced system, all moving rigs at once.
    pub reduced: DMatrix<f64>,
    row_of: Vec<Option<usize>>,
    points: Vec<Option<Matrix3<f64>>>,
}
// ANCHOR_END: covariance

impl<const D: usize> Covariance<D> {
    /// The D×D covariance of a camera's small vector; `None` for a camera that is held or
    /// does not exist.
    pub fn camera(&self, index: usize) -> Option<SMatrix<f64, D, D>> {
        let row = (*self.row_of.get(index)?)?;
        Some(self.block(row, row))
    }

    /// The 3×3 covariance of a point in square metres; `None` for a point that was dropped
    /// or does not exist.
    pub fn point(&self, index: usize) -> Option<Matrix3<f64>> {
        *self.points.get(index)?
    }

    /// What two rows of blocks of the reduced system have in common.
    fn block(&self, row: usize, column: usize) -> SMatrix<f64, D, D> {
        self.reduced.fixed_view::<D, D>(D * row, D * column).into_owned()
    }
}

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// Covariances where the solver stands, relative to what is fixed.
    ///
    /// # Errors
    ///
    /// [`BaError::RankDeficient`] when what is fixed leaves directions free, and
    /// [`BaError::Ray`] when a point is free.
    pub fn covariance(&mut self) -> Result<Covariance<D>, BaError> {
        self.eliminate(0.0).map_err(|singular| self.explain(singular))?;
        self.system.factorize().map_err(|singular| self.explain(singular))?;
        let size = D * self.layout.rows;
        let mut inverse = DMatrix::zeros(size, size);
        let mut column = vec![[0.0; D]; self.layout.rows];
        for index in 0..size {
            column.fill([0.0; D]);
            column[index / D][index % D] = 1.0;
            self.system.reduced.solve_lower(&mut column);
            self.system.reduced.solve_upper(&mut column);
            inverse.column_mut(index).copy_from_slice(column.as_flattened());
        }
        Ok(self.with_points(inverse))
    }

    /// Covariances with nothing held beyond what is fixed: the pseudo-inverse of the
    /// reduced system. The directions that no pixel sees have no share in it, so a
    /// covariance is that of an error from which these directions are removed.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free.
    pub fn minimal_norm_covariance(&mut self) -> Result<Covariance<D>, BaError> {
        let (seen, values) = self.seen_directions()?;
        let inverse = &seen * DMatrix::from_diagonal(&values.map(f64::recip)) * seen.transpose();
        Ok(self.with_points(inverse))
    }

    // ANCHOR: point_covariance
    /// Adds the points: what a landmark's own pixels leave open, and what the cameras that
    /// saw it hand on.
    fn with_points(&mut self, reduced: DMatrix<f64>) -> Covariance<D> {
        let row_of = self.layout.row_of.clone();
        let points = vec![None; self.points().len()];
        let mut covariance = Covariance { reduced, row_of, points };
        for index in 0..self.layout.landmarks.len() {
            let couplings = self.couplings(index);
            let mut sum = Matrix3::identity();
            for (row, left) in &couplings {
                for (column, right) in &couplings {
                    sum += left.transpose() * covariance.block(*row, *column) * right;
                }
            }
            let factor = &self.system.eliminated[index].inverse_factor;
            let point = self.layout.landmarks[index].point;
            covariance.points[point] = Some(factor.tr_mul(&sum) * factor);
        }
        covariance
    }
    // ANCHOR_END: point_covariance
}
