//! H δ = −g, all of it: the dense linear system.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::group::Point;
use super::problem::{Buffer, Columns, Problem, Row};
use super::solver::{LinearSystem, Prediction, SolveError};
use super::{Covariance, Values};

/// A pivot of the Hessian, scaled to a unit diagonal, below this is lost in rounding.
pub(crate) const LOST_PIVOT: f64 = 1e-14;

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
        for (row, scale) in self.scale.iter_mut().enumerate() {
            let diagonal = self.hessian[(row, row)];
            *scale = if diagonal > 0.0 { 1.0 / diagonal.sqrt() } else { 1.0 };
        }
        let sums = self.gradient.iter().chain(&self.hessian).chain(&self.scale);
        let is_finite = self.cost.is_finite() && sums.into_iter().all(|sum| sum.is_finite());
        // A derivative whose square underflows has left its trace in the gradient.
        let vanished = |row: usize| self.gradient[row] != 0.0 && self.hessian[(row, row)] == 0.0;
        is_finite && !(0..self.gradient.len()).any(vanished)
    }

    /// Norm of the scaled gradient. Its entries say by how many of its own standard deviations
    /// each coordinate alone would still move, all others held.
    pub fn gradient_norm(&self) -> f64 {
        let squares = self.gradient.iter().zip(&self.scale).map(|(g, scale)| (g * scale).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// The step δ that solves (H + λ diag H) δ = −g, for the damping λ. With no damping it is the
    /// Gauss-Newton step. `None` when the matrix is singular to rounding. Implements
    /// {eq:damped-step}, {eq:normal-equations} and {eq:predicted-decrease}.
    pub fn step(&self, damping: f64) -> Option<Step> {
        let mut step = Step::zeros(self.scale.len());
        let mut matrix = DMatrix::zeros(self.scale.len(), self.scale.len());
        self.step_into(damping, &mut matrix, &mut step).then_some(step)
    }

    // ANCHOR: step
    /// Writes that step, with memory for a matrix. False when there is none.
    fn step_into(&self, damping: f64, memory: &mut DMatrix<f64>, into: &mut Step) -> bool {
        let Self { hessian, gradient, scale, .. } = self;
        let mut damped = std::mem::take(memory);
        if damped.nrows() != scale.len() {
            damped = DMatrix::zeros(scale.len(), scale.len());
        }
        for (row, column) in (0..scale.len()).flat_map(|r| (0..=r).map(move |c| (r, c))) {
            damped[(row, column)] = scale[row] * hessian[(row, column)] * scale[column];
        }
        (0..scale.len()).for_each(|row| damped[(row, row)] += damping);
        let Some(factor) = Cholesky::new(damped) else { return false };
        into.step.zip_zip_apply(gradient, scale, |step, gradient, scale| *step = -scale * gradient);
        factor.solve_mut(&mut into.step);
        // g + (H + λ D) δ = 0 turns −gᵀδ − ½ δᵀHδ into the sum of two positive terms.
        into.norm = into.step.norm();
        into.step.component_mul_assign(scale);
        let descent = -gradient.dot(&into.step);
        into.predicted_decrease = 0.5 * (damping * into.norm * into.norm + descent);
        into.smallest_pivot = smallest_pivot(&factor);
        *memory = factor.unpack_dirty();
        damping > 0.0 || into.smallest_pivot > LOST_PIVOT
    }
    // ANCHOR_END: step
}

impl Step {
    fn zeros(dimension: usize) -> Self {
        let step = DVector::zeros(dimension);
        Self { step, norm: 0.0, predicted_decrease: 0.0, smallest_pivot: 0.0 }
    }
}

fn smallest_pivot(factor: &Cholesky<f64, Dyn>) -> f64 {
    let matrix = factor.l_dirty();
    (0..matrix.nrows()).map(|row| matrix[(row, row)]).fold(f64::INFINITY, f64::min).powi(2)
}

/// The normal equations as a linear system, with the memory that making them needs. Right for
/// hundreds of columns; the structure of thousands of landmarks needs
/// [`LandmarkElimination`](super::LandmarkElimination).
#[derive(Debug, Clone)]
pub struct Dense {
    equations: NormalEquations,
    step: Step,
    /// For the factor of the damped Hessian.
    matrix: DMatrix<f64>,
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
        let columns = problem.columns_to_solve()?;
        let equations = NormalEquations::zeros(columns.count);
        let matrix = DMatrix::zeros(columns.count, columns.count);
        let step = Step::zeros(columns.count);
        Ok(Self { equations, step, matrix, columns, buffer: Buffer::default() })
    }

    /// The normal equations of the last linearization.
    pub fn into_equations(self) -> NormalEquations {
        self.equations
    }
}

impl LinearSystem for Dense {
    // ANCHOR: linearize
    fn linearize(&mut self, problem: &Problem, at: Point) -> Result<Option<f64>, SolveError> {
        let Self { equations, columns, buffer, .. } = self;
        equations.gradient.fill(0.0);
        equations.hessian.fill(0.0);
        equations.cost = problem.each_row(at, columns, buffer, |row| equations.accumulate(&row))?;
        if equations.complete() { Ok(Some(equations.cost)) } else { Err(SolveError::OutOfRange) }
    }
    // ANCHOR_END: linearize

    fn step(&mut self, damping: f64, into: &mut [f64]) -> Option<Prediction> {
        let Self { equations, step, matrix, columns, .. } = self;
        equations.step_into(damping, matrix, step).then_some(())?;
        columns.spread(step.step.as_slice(), into);
        let Step { norm, predicted_decrease, .. } = *step;
        let gradient_norm = equations.gradient_norm();
        Some(Prediction { step_norm: norm, predicted_decrease, gradient_norm })
    }

    /// The Hessian has squared what there is to see; its Jacobian decides.
    fn is_suspicious(&self) -> bool {
        self.step.smallest_pivot < SUSPICIOUS_PIVOT
    }

    fn gradient_norm(&self) -> f64 {
        self.equations.gradient_norm()
    }

    fn covariance(&mut self, problem: &Problem, at: Point) -> Result<Covariance, SolveError> {
        Covariance::dense(problem, at)
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
    pub fn linearize(&self, values: &Values) -> Result<NormalEquations, SolveError> {
        self.check_values(values)?;
        let mut system = Dense::new(self)?;
        self.at(values, |at| system.linearize(self, at))?;
        Ok(system.into_equations())
    }

    /// Calls with these values and the linearization point that belongs to them.
    pub(super) fn at<T>(&self, values: &Values, call: impl FnOnce(Point) -> T) -> T {
        let mut frozen = self.linearization_point();
        if let Some(point) = &mut frozen {
            self.follow(values, point);
        }
        call(Point { values, frozen: frozen.as_ref() })
    }
}
