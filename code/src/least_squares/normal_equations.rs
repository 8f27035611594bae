//! H δ = −g, all of it: the dense linear system.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::group::Point;
use super::problem::{Buffer, Columns, Problem, Row};
use super::solver::{LinearSystem, Prediction, SolveError};

/// A pivot of the Hessian, scaled to a unit diagonal, below this is lost in rounding.
const LOST_PIVOT: f64 = 1e-14;

/// A pivot below this asks whether the Jacobian has full rank.
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
    /// The change of every column.
    pub step: DVector<f64>,
    /// Its length, each coordinate measured by what changes one whitened unit.
    pub norm: f64,
    /// By how much the cost falls if the residuals are linear.
    pub predicted_decrease: f64,
    /// The smallest pivot of the damped, scaled Hessian.
    smallest_pivot: f64,
}

impl NormalEquations {
    fn zeros(dimension: usize) -> Self {
        Self {
            cost: 0.0,
            gradient: DVector::zeros(dimension),
            hessian: DMatrix::zeros(dimension, dimension),
            scale: DVector::zeros(dimension),
        }
    }

    // ANCHOR: accumulate
    /// Adds one row r, with its derivatives, to gradient and Hessian.
    fn accumulate(&mut self, row: &Row) {
        for (at, &(column, slope)) in row.entries.iter().enumerate() {
            self.gradient[column] += slope * row.residual;
            for &(other, other_slope) in &row.entries[..=at] {
                let below = (column.max(other), column.min(other));
                self.hessian[below] += slope * other_slope;
            }
        }
    }
    // ANCHOR_END: accumulate

    /// Fills in the upper triangle and the scale, once everything has been added. False when a
    /// sum has left the range of the numbers.
    fn complete(&mut self) -> bool {
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
        let smallest_pivot = smallest_pivot(&factor);
        let is_regular = damping > 0.0 || smallest_pivot > LOST_PIVOT;
        is_regular.then_some(Step { step, norm, predicted_decrease, smallest_pivot })
    }
    // ANCHOR_END: step
}

fn smallest_pivot(factor: &Cholesky<f64, Dyn>) -> f64 {
    factor.l_dirty().diagonal().min().powi(2)
}

/// The normal equations as a linear system, with the memory that making them needs. Right for
/// hundreds of columns; the structure of thousands of landmarks needs
/// [`LandmarkElimination`](super::LandmarkElimination).
#[derive(Debug, Clone)]
pub struct Dense {
    equations: NormalEquations,
    columns: Columns,
    buffer: Buffer,
}

impl Dense {
    /// Room for the equations of a problem.
    ///
    /// # Errors
    ///
    /// [`SolveError::NoFactors`] and [`SolveError::NothingFree`].
    pub fn new(problem: &Problem) -> Result<Self, SolveError> {
        let columns = problem.columns();
        if problem.is_empty() {
            return Err(SolveError::NoFactors);
        }
        if columns.count == 0 {
            return Err(SolveError::NothingFree);
        }
        let equations = NormalEquations::zeros(columns.count);
        Ok(Self { equations, columns, buffer: Buffer::default() })
    }

    /// The normal equations of the last linearization.
    pub fn into_equations(self) -> NormalEquations {
        self.equations
    }
}

impl LinearSystem for Dense {
    // ANCHOR: linearize
    fn linearize(&mut self, problem: &Problem, at: Point) -> Result<(), SolveError> {
        let Self { equations, columns, buffer } = self;
        equations.gradient.fill(0.0);
        equations.hessian.fill(0.0);
        equations.cost = problem.each_row(at, columns, buffer, |row| equations.accumulate(&row))?;
        if equations.complete() { Ok(()) } else { Err(SolveError::OutOfRange) }
    }
    // ANCHOR_END: linearize

    fn step(
        &mut self,
        problem: &Problem,
        at: Point,
        damping: f64,
        into: &mut [f64],
    ) -> Option<Prediction> {
        let step = self.equations.step(damping)?;
        if damping == 0.0 && step.smallest_pivot < SUSPICIOUS_PIVOT {
            // The Hessian has squared what there is to see; its Jacobian decides.
            problem.null_space_at(at).ok().filter(|null_space| null_space.nullity() == 0)?;
        }
        self.columns.spread(step.step.as_slice(), into);
        let Step { norm, predicted_decrease, .. } = step;
        let gradient_norm = self.equations.gradient_norm();
        Some(Prediction { step_norm: norm, predicted_decrease, gradient_norm })
    }

    fn gradient_norm(&mut self, _problem: &Problem, _at: Point) -> Result<f64, SolveError> {
        Ok(self.equations.gradient_norm())
    }
}

impl Problem {
    /// Cost, gradient and Gauss-Newton Hessian at `values`, with the linearization points that are
    /// frozen.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when the problem is empty, `values` do not fit it, or a residual is
    /// undefined or not finite there.
    pub fn linearize(&self, values: &super::Values) -> Result<NormalEquations, SolveError> {
        self.check_values(values)?;
        let mut system = Dense::new(self)?;
        self.at(values, |at| system.linearize(self, at))?;
        Ok(system.into_equations())
    }

    /// Calls with these values and the linearization point that belongs to them.
    pub(super) fn at<T>(&self, values: &super::Values, call: impl FnOnce(Point) -> T) -> T {
        let mut frozen = self.linearization_point();
        if let Some(point) = &mut frozen {
            self.follow(values, point);
        }
        call(Point { values, frozen: frozen.as_ref() })
    }
}
