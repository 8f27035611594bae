//! Variables and the residuals between them.

use std::ops::Range;

use nalgebra::{DMatrixView, DVectorView};
use thiserror::Error;

use super::kernel::{Kernel, KernelError};
use super::normal_equations::{Covariance, NormalEquations};
use super::residual::{Evaluation, Residual, Undefined};
use super::solver::SolveError;
use super::variable::Manifold;

/// A least-squares problem: variables of one type, some of them fixed, and residual blocks.
///
/// Solving it does not change it: it keeps the values that it was given, and a solution has its
/// own.
pub struct Problem<V> {
    values: Vec<V>,
    fixed: Vec<bool>,
    blocks: Vec<Block<V>>,
}

struct Block<V> {
    residual: Box<dyn Residual<V>>,
    kernel: Kernel,
}

impl<V: Manifold> Default for Problem<V> {
    fn default() -> Self {
        Self::new()
    }
}

impl<V: Manifold> Problem<V> {
    /// A problem without variables and residuals.
    pub fn new() -> Self {
        Self { values: Vec::new(), fixed: Vec::new(), blocks: Vec::new() }
    }

    /// Adds a variable that begins at `value`, and gives its index.
    pub fn add_variable(&mut self, value: V) -> usize {
        self.values.push(value);
        self.fixed.push(false);
        self.values.len() - 1
    }

    /// Keeps a variable where it is.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`].
    pub fn fix(&mut self, variable: usize) -> Result<(), ProblemError> {
        let variables = self.values.len();
        let fixed = self.fixed.get_mut(variable);
        *fixed.ok_or(ProblemError::NoSuchVariable { variable, variables })? = true;
        Ok(())
    }

    /// Adds a residual with its kernel, and gives its index.
    ///
    /// # Errors
    ///
    /// A [`ProblemError`] when it names a variable that does not exist, or one twice, when it has
    /// no numbers, or when the kernel's parameter is not positive.
    pub fn add_residual(
        &mut self,
        residual: impl Residual<V> + 'static,
        kernel: Kernel,
    ) -> Result<usize, ProblemError> {
        kernel.check()?;
        let (index, variables) = (self.blocks.len(), self.values.len());
        if residual.dimension() == 0 {
            return Err(ProblemError::EmptyResidual { residual: index });
        }
        let named = residual.variables();
        for (slot, &variable) in named.iter().enumerate() {
            if variable >= variables {
                return Err(ProblemError::NoSuchVariable { variable, variables });
            }
            if named[..slot].contains(&variable) {
                return Err(ProblemError::RepeatedVariable { residual: index, variable });
            }
        }
        self.blocks.push(Block { residual: Box::new(residual), kernel });
        Ok(index)
    }

    /// The values the variables begin at, by index.
    pub fn values(&self) -> &[V] {
        &self.values
    }

    /// Lets the next solve begin elsewhere.
    ///
    /// # Errors
    ///
    /// [`SolveError::WrongValues`] when their number or a dimension differs.
    pub fn set_values(&mut self, values: Vec<V>) -> Result<(), SolveError> {
        self.check_values(&values)?;
        self.values = values;
        Ok(())
    }

    /// Rows of a variable in the gradient, the Hessian and their null space, or `None` when it is
    /// fixed or does not exist.
    pub fn rows_of(&self, variable: usize) -> Option<Range<usize>> {
        Layout::of(self).rows.get(variable).cloned().flatten()
    }

    /// Cost, gradient and Gauss-Newton Hessian at `values`.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when the problem is empty, `values` do not fit it, or a residual is
    /// undefined or not finite there.
    pub fn linearize(&self, values: &[V]) -> Result<NormalEquations, SolveError> {
        self.check_values(values)?;
        let mut workspace = Workspace::of(self)?;
        let mut system = NormalEquations::zeros(workspace.layout.dimension);
        self.linearize_into(values, &mut workspace, &mut system)?;
        Ok(system)
    }

    /// The covariance of the estimate `values`, the inverse of the Hessian there.
    ///
    /// It is the covariance to first order, under four conditions: `values` minimize the cost, the
    /// whitened noise has unit covariance and is independent between residuals, the model is
    /// nearly linear over the spread, and no kernel weighs anything down. It is not scaled by
    /// the residuals that are left. Each variable's part is that of its `retract` step.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`] when some direction is not determined, and those of
    /// [`Problem::linearize`].
    pub fn covariance(&self, values: &[V]) -> Result<Covariance, SolveError> {
        let system = self.linearize(values)?;
        Ok(Covariance::new(system.covariance()?, Layout::of(self).rows))
    }

    // ANCHOR: linearize
    /// Evaluates every residual at `values` and adds it to the normal equations.
    pub(super) fn linearize_into(
        &self,
        values: &[V],
        workspace: &mut Workspace,
        system: &mut NormalEquations,
    ) -> Result<(), SolveError> {
        system.clear();
        for index in 0..self.blocks.len() {
            self.evaluate(index, values, workspace)?;
            self.accumulate(index, workspace, system);
        }
        if system.complete() { Ok(()) } else { Err(SolveError::OutOfRange) }
    }
    // ANCHOR_END: linearize

    /// Writes residual and Jacobian of one block to the workspace.
    fn evaluate(
        &self,
        index: usize,
        values: &[V],
        workspace: &mut Workspace,
    ) -> Result<(), SolveError> {
        let residual = &self.blocks[index].residual;
        workspace.rows = residual.dimension();
        workspace.starts.clear();
        workspace.starts.push(0);
        let mut columns = 0;
        for &variable in residual.variables() {
            columns += values[variable].dimension();
            workspace.starts.push(columns);
        }
        let numbers = &mut workspace.residual[..workspace.rows];
        let jacobian = &mut workspace.jacobian[..workspace.rows * columns];
        let mut evaluation = Evaluation::new(index, numbers, jacobian, &workspace.starts);
        let outcome = residual.evaluate(values, &mut evaluation);
        if let Some(misfit) = evaluation.misfit() {
            return Err(misfit);
        }
        outcome.map_err(|Undefined| SolveError::Undefined { residual: index })?;
        if numbers.iter().chain(jacobian.iter()).all(|entry| entry.is_finite()) {
            Ok(())
        } else {
            Err(SolveError::NotFinite { residual: index })
        }
    }

    // ANCHOR: accumulate
    /// Adds the block in the workspace to cost, gradient and the lower triangle of the Hessian.
    fn accumulate(&self, index: usize, workspace: &Workspace, system: &mut NormalEquations) {
        let Block { residual, kernel } = &self.blocks[index];
        let r = workspace.residual();
        let norm = r.norm();
        let weight = kernel.weight(norm);
        system.cost += kernel.cost(norm);
        let free = |slot: usize| {
            let rows = workspace.layout.rows[residual.variables()[slot]].clone()?;
            Some((rows, workspace.jacobian(slot)))
        };
        let slots = residual.variables().len();
        for (rows, jacobian) in (0..slots).filter_map(free) {
            let mut gradient = system.gradient.rows_range_mut(rows.clone());
            gradient.gemv_tr(weight, &jacobian, &r, 1.0);
            for (columns, other) in (0..slots).filter_map(free) {
                if columns.start <= rows.start {
                    let mut block = system.hessian.view_range_mut(rows.clone(), columns);
                    block.gemm_tr(weight, &jacobian, &other, 1.0);
                }
            }
        }
    }
    // ANCHOR_END: accumulate

    fn check_values(&self, values: &[V]) -> Result<(), SolveError> {
        let fit = |(old, new): (&V, &V)| old.dimension() == new.dimension();
        if values.len() == self.values.len() && self.values.iter().zip(values).all(fit) {
            Ok(())
        } else {
            Err(SolveError::WrongValues { given: values.len(), expected: self.values.len() })
        }
    }
}

/// Which rows of the normal equations belong to which variable.
pub(super) struct Layout {
    /// By variable; `None` for one that is fixed.
    pub(super) rows: Vec<Option<Range<usize>>>,
    /// The number of all rows.
    pub(super) dimension: usize,
}

impl Layout {
    fn of<V: Manifold>(problem: &Problem<V>) -> Self {
        let mut dimension = 0;
        let variables = problem.values.iter().zip(&problem.fixed);
        let rows = variables.map(|(value, fixed)| {
            let start = dimension;
            (!fixed).then(|| {
                dimension += value.dimension();
                start..dimension
            })
        });
        let rows = rows.collect();
        Self { rows, dimension }
    }
}

/// What evaluating residuals needs; allocated once, for the largest of them.
pub(super) struct Workspace {
    pub(super) layout: Layout,
    residual: Vec<f64>,
    jacobian: Vec<f64>,
    rows: usize,
    starts: Vec<usize>,
}

impl Workspace {
    /// A workspace for a problem that has something to solve.
    pub(super) fn of<V: Manifold>(problem: &Problem<V>) -> Result<Self, SolveError> {
        if problem.blocks.is_empty() {
            return Err(SolveError::NoResiduals);
        }
        let layout = Layout::of(problem);
        if layout.dimension == 0 {
            return Err(SolveError::NothingFree);
        }
        let (mut rows, mut entries, mut slots) = (0, 0, 0);
        for Block { residual, .. } in &problem.blocks {
            let named = residual.variables();
            let columns: usize = named.iter().map(|&v| problem.values[v].dimension()).sum();
            rows = rows.max(residual.dimension());
            entries = entries.max(residual.dimension() * columns);
            slots = slots.max(named.len());
        }
        Ok(Self {
            layout,
            residual: vec![0.0; rows],
            jacobian: vec![0.0; entries],
            rows: 0,
            starts: Vec::with_capacity(slots + 1),
        })
    }

    fn residual(&self) -> DVectorView<'_, f64> {
        DVectorView::from_slice(&self.residual[..self.rows], self.rows)
    }

    /// The Jacobian block of the current residual's `slot`-th variable.
    fn jacobian(&self, slot: usize) -> DMatrixView<'_, f64> {
        let (start, end) = (self.starts[slot], self.starts[slot + 1]);
        let entries = &self.jacobian[start * self.rows..end * self.rows];
        DMatrixView::from_slice(entries, self.rows, end - start)
    }
}

/// Why a variable or residual cannot be part of a problem.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ProblemError {
    /// An index is out of range.
    #[error("variable {variable} does not exist; the problem has {variables}, add it first")]
    NoSuchVariable {
        /// The index given.
        variable: usize,
        /// The number of variables.
        variables: usize,
    },
    /// A residual names a variable twice.
    #[error(
        "residual {residual} names variable {variable} twice; add both derivatives in one block"
    )]
    RepeatedVariable {
        /// The residual's index.
        residual: usize,
        /// The variable's index.
        variable: usize,
    },
    /// A residual has no numbers.
    #[error("residual {residual} has dimension 0; give it at least one number or leave it out")]
    EmptyResidual {
        /// The residual's index.
        residual: usize,
    },
    /// A kernel has an impossible parameter.
    #[error(transparent)]
    Kernel(#[from] KernelError),
}
