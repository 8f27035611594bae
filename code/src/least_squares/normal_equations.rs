//! H δ = −g: its solution, the directions it leaves free, and what its inverse means.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DMatrixView, DVector, Dyn, SymmetricEigen};
use thiserror::Error;

/// A direction counts as free when its eigenvalue of the Hessian, scaled to a unit diagonal, is
/// below this fraction of the largest one: it is then known a million times worse than another.
pub const FREE_BELOW: f64 = 1e-12;

/// A pivot of the scaled Hessian below this asks for a look at the eigenvalues, none of which
/// can lie above every pivot.
const SUSPICIOUS_PIVOT: f64 = 1e-8;

/// The normal equations of a problem at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations {
    /// Σ ρ(‖r‖): {eq:robust-cost}.
    pub cost: f64,
    /// Σ w Jᵀ r, the gradient of the cost: {eq:cost-gradient}, with kernels {eq:kernel-weight}.
    pub gradient: DVector<f64>,
    /// Σ w Jᵀ J, symmetric.
    pub hessian: DMatrix<f64>,
    /// One over the root of the Hessian's diagonal: what one whitened unit is worth in each
    /// coordinate. One where the diagonal is zero.
    scale: DVector<f64>,
}

/// A step that the normal equations propose.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The change of every free variable.
    pub step: DVector<f64>,
    /// Its length, each coordinate measured by what changes one whitened unit.
    pub norm: f64,
    /// By how much the cost falls if the residuals are linear.
    pub predicted_decrease: f64,
}

impl NormalEquations {
    pub(super) fn zeros(dimension: usize) -> Self {
        Self {
            cost: 0.0,
            gradient: DVector::zeros(dimension),
            hessian: DMatrix::zeros(dimension, dimension),
            scale: DVector::zeros(dimension),
        }
    }

    pub(super) fn clear(&mut self) {
        self.cost = 0.0;
        self.gradient.fill(0.0);
        self.hessian.fill(0.0);
    }

    /// Fills in the upper triangle and the scale, once everything has been added. False when a
    /// sum has left the range of the numbers.
    pub(super) fn complete(&mut self) -> bool {
        self.hessian.fill_upper_triangle_with_lower_triangle();
        for (scale, &diagonal) in self.scale.iter_mut().zip(self.hessian.diagonal().iter()) {
            *scale = if diagonal > 0.0 { 1.0 / diagonal.sqrt() } else { 1.0 };
        }
        let sums = self.gradient.iter().chain(&self.hessian).chain(&self.scale);
        let is_finite = self.cost.is_finite() && sums.into_iter().all(|sum| sum.is_finite());
        // A derivative whose square underflows has left its trace in the gradient.
        let diagonal = self.hessian.diagonal();
        let vanished = |(gradient, diagonal): (&f64, &f64)| *gradient != 0.0 && *diagonal == 0.0;
        is_finite && !self.gradient.iter().zip(&diagonal).any(vanished)
    }

    /// Norm of the scaled gradient. Its entries say by how many of its own standard deviations
    /// each coordinate alone would still move, all others held.
    pub fn gradient_norm(&self) -> f64 {
        self.gradient.component_mul(&self.scale).norm()
    }

    /// The Hessian with rows and columns scaled to a unit diagonal.
    fn scaled_hessian(&self) -> DMatrix<f64> {
        let scaled =
            |row, column| self.scale[row] * self.hessian[(row, column)] * self.scale[column];
        DMatrix::from_fn(self.scale.len(), self.scale.len(), scaled)
    }

    // ANCHOR: step
    /// The step δ that solves (H + λ diag H) δ = −g, for the damping λ. With no damping it is the
    /// Gauss-Newton step. `None` when the matrix is singular to rounding. Implements
    /// {eq:damped-step}, {eq:normal-equations} and {eq:predicted-decrease}.
    pub fn step(&self, damping: f64) -> Option<Step> {
        let mut damped = self.scaled_hessian();
        for row in 0..self.scale.len() {
            damped[(row, row)] += damping;
        }
        let factor = Cholesky::new(damped)?;
        let scaled_gradient = self.gradient.component_mul(&self.scale);
        let scaled_step = -factor.solve(&scaled_gradient);
        // g + (H + λ D) δ = 0 turns −gᵀδ − ½ δᵀHδ into this sum of two positive terms.
        let norm = scaled_step.norm();
        let predicted_decrease = 0.5 * (damping * norm * norm - scaled_gradient.dot(&scaled_step));
        let step = scaled_step.component_mul(&self.scale);
        let is_regular = damping > 0.0 || !self.may_be_singular(&factor);
        is_regular.then_some(Step { step, norm, predicted_decrease })
    }
    // ANCHOR_END: step

    /// Looks at the eigenvalues only when a pivot asks for it.
    fn may_be_singular(&self, factor: &Cholesky<f64, Dyn>) -> bool {
        let smallest_pivot = factor.l_dirty().diagonal().min().powi(2);
        smallest_pivot < SUSPICIOUS_PIVOT && self.free_directions() > 0
    }

    // ANCHOR: free_directions
    /// In how many independent directions all variables can move together without any residual
    /// changing to first order: the nullity of the Hessian, scaled to a unit diagonal, to
    /// [`FREE_BELOW`].
    pub fn free_directions(&self) -> usize {
        let eigenvalues = self.scaled_hessian().symmetric_eigenvalues();
        let threshold = FREE_BELOW * eigenvalues.max();
        eigenvalues.iter().filter(|eigenvalue| **eigenvalue <= threshold).count()
    }

    /// The free directions of the scaled Hessian, or `None` when there are none.
    fn free_part(&self, scaled: &SymmetricEigen<f64, Dyn>) -> Option<SingularSystem> {
        let threshold = FREE_BELOW * scaled.eigenvalues.max();
        let dimension = self.scale.len();
        let is_free = |column: &usize| scaled.eigenvalues[*column] <= threshold;
        let free: Vec<usize> = (0..dimension).filter(is_free).collect();
        if free.is_empty() {
            return None;
        }
        // A null vector of the scaled matrix, scaled once more, is one of the Hessian.
        let null = DMatrix::from_fn(dimension, free.len(), |row, column| {
            self.scale[row] * scaled.eigenvectors[(row, free[column])]
        });
        Some(SingularSystem { free: free.len(), dimension, basis: null.qr().q() })
    }
    // ANCHOR_END: free_directions

    /// The free directions, or `None` when the system determines every direction.
    pub fn singular(&self) -> Option<SingularSystem> {
        self.free_part(&self.scaled_hessian().symmetric_eigen())
    }

    // ANCHOR: covariance
    /// The inverse of the Hessian. Implements {eq:estimate-covariance}.
    ///
    /// # Errors
    ///
    /// [`SingularSystem`] when some direction is free: its variance would be infinite.
    pub fn covariance(&self) -> Result<DMatrix<f64>, SingularSystem> {
        let scaled = self.scaled_hessian().symmetric_eigen();
        if let Some(singular) = self.free_part(&scaled) {
            return Err(singular);
        }
        // V Λ⁻¹ Vᵀ, of which the unscaled rows of V and the roots of Λ⁻¹ make one square.
        let root = DMatrix::from_fn(self.scale.len(), self.scale.len(), |row, column| {
            self.scale[row] * scaled.eigenvectors[(row, column)] / scaled.eigenvalues[column].sqrt()
        });
        Ok(&root * root.transpose())
    }
    // ANCHOR_END: covariance
}

/// The measurements leave directions in which everything can move and no residual changes.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "the system leaves {free} of {dimension} directions free; fix variables or add measurements"
)]
pub struct SingularSystem {
    /// The number of free directions.
    pub free: usize,
    /// The number of all directions.
    pub dimension: usize,
    /// An orthonormal basis of the free directions, one in each column. The rows of a variable
    /// are those of [`Problem::rows_of`](super::Problem::rows_of).
    pub basis: DMatrix<f64>,
}

/// The covariance of an estimate, by variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    matrix: DMatrix<f64>,
    rows: Vec<Option<Range<usize>>>,
}

impl Covariance {
    pub(super) fn new(matrix: DMatrix<f64>, rows: Vec<Option<Range<usize>>>) -> Self {
        Self { matrix, rows }
    }

    /// The covariance of all free variables together.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// The covariance of one variable, whatever the others are: its *marginal*. `None` when the
    /// variable is fixed or does not exist.
    pub fn of(&self, variable: usize) -> Option<DMatrixView<'_, f64>> {
        self.between(variable, variable)
    }

    /// The covariance between two variables, with the rows of the first and the columns of the
    /// second. `None` when one is fixed or does not exist.
    pub fn between(&self, first: usize, second: usize) -> Option<DMatrixView<'_, f64>> {
        let rows = self.rows.get(first)?.clone()?;
        let columns = self.rows.get(second)?.clone()?;
        Some(self.matrix.view_range(rows, columns))
    }
}
