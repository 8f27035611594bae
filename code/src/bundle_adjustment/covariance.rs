//! How well cameras and points are known.

use nalgebra::{DMatrix, Matrix3, SMatrix};

use super::{BaError, Camera, Solver};
use crate::least_squares::{Covariance, LinearSystem, SolveError};

// ANCHOR: covariance
/// Covariances of cameras and points, to first order, for noise of the standard deviations
/// that the observations state.
///
/// What is held has no covariance: all of it is relative to the gauge.
#[derive(Debug, Clone, PartialEq)]
pub struct BaCovariance<const D: usize> {
    /// The inverse of the Schur complement, or its pseudo-inverse from
    /// [`Solver::minimal_norm_covariance`], all moving rigs at once: D rows for each of
    /// [`Solver::rows`].
    pub cameras: DMatrix<f64>,
    row_of: Vec<Option<usize>>,
    points: Vec<Option<Matrix3<f64>>>,
}
// ANCHOR_END: covariance

impl<const D: usize> BaCovariance<D> {
    /// The D×D covariance of a camera's small vector; `None` for a camera that is held or
    /// does not exist.
    pub fn camera(&self, index: usize) -> Option<SMatrix<f64, D, D>> {
        let row = (*self.row_of.get(index)?)?;
        Some(self.cameras.fixed_view::<D, D>(D * row, D * row).into_owned())
    }

    /// The 3×3 covariance of a point in square metres; `None` for a point that was dropped
    /// or does not exist.
    pub fn point(&self, index: usize) -> Option<Matrix3<f64>> {
        *self.points.get(index)?
    }
}

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// Covariances where the solver stands, relative to what is fixed.
    ///
    /// # Errors
    ///
    /// [`BaError::RankDeficient`] when what is fixed leaves directions free, and
    /// [`BaError::Ray`] when a point is free. [`BaError::Solve`] when that cannot be said, or when
    /// the Schur complement has lost it to rounding.
    pub fn covariance(&self) -> Result<BaCovariance<D>, BaError> {
        let covariance = LinearSystem::covariance(&mut self.system(), self.problem(), self.at());
        Ok(self.sorted(&covariance.map_err(|error| match error {
            SolveError::Singular(_) => self.explain(),
            error => error.into(),
        })?))
    }

    /// Covariances with nothing held beyond what is fixed: the pseudo-inverse of the Schur
    /// complement. The directions that no pixel sees have no share in it, so a covariance is
    /// that of an error from which these directions are removed.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free, and [`BaError::Solve`] as for [`Solver::covariance`].
    pub fn minimal_norm_covariance(&self) -> Result<BaCovariance<D>, BaError> {
        let (inverse, _) = self.pseudo_inverse()?;
        let covariance = self.system().with_landmarks(self.problem(), inverse);
        Ok(self.sorted(&covariance.map_err(|_| self.explain_points())?))
    }

    /// Camera by camera and point by point.
    fn sorted(&self, covariance: &Covariance) -> BaCovariance<D> {
        let of = |point| covariance.of(point).map(|own| own.fixed_view::<3, 3>(0, 0).into_owned());
        let points = self.assembly.points.iter().map(|point| of(*point)).collect();
        BaCovariance { cameras: covariance.matrix().clone(), row_of: self.rows(), points }
    }
}
