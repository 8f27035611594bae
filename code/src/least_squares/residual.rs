//! What a measurement contributes to a problem.

use nalgebra::{DMatrixViewMut, Dim, Matrix, Storage, U1};

use super::solver::SolveError;

/// A residual has no value at the variables it was asked about, as the pixel of a point behind
/// the camera has none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Undefined;

// ANCHOR: residual
/// A whitened residual, what the model gives less what was measured in standard deviations,
/// and its derivatives.
pub trait Residual<V> {
    /// Indices of the variables it depends on, without repetition.
    fn variables(&self) -> &[usize];

    /// How many numbers it has.
    fn dimension(&self) -> usize;

    /// Writes the residual and one Jacobian block for each of its variables. `values` holds all
    /// variables of the problem.
    ///
    /// # Errors
    ///
    /// [`Undefined`] where the residual has no value.
    fn evaluate(&self, values: &[V], into: &mut Evaluation) -> Result<(), Undefined>;
}
// ANCHOR_END: residual

/// Where a residual writes its value and its Jacobian. What is not written is zero.
pub struct Evaluation<'a> {
    index: usize,
    residual: &'a mut [f64],
    jacobian: DMatrixViewMut<'a, f64>,
    /// First column of each variable's block, and the number of all columns.
    starts: &'a [usize],
    misfit: Option<SolveError>,
}

impl<'a> Evaluation<'a> {
    /// Room for residual `index`, filled with zeros. The Jacobian has a row for every number of
    /// the residual and as many columns as the last of `starts` says.
    pub(super) fn new(
        index: usize,
        residual: &'a mut [f64],
        jacobian: &'a mut [f64],
        starts: &'a [usize],
    ) -> Self {
        residual.fill(0.0);
        jacobian.fill(0.0);
        let columns = starts[starts.len() - 1];
        let jacobian = DMatrixViewMut::from_slice(jacobian, residual.len(), columns);
        Self { index, residual, jacobian, starts, misfit: None }
    }

    /// Writes the whitened residual.
    pub fn residual<R: Dim, S: Storage<f64, R, U1>>(&mut self, value: &Matrix<f64, R, U1, S>) {
        let expected = (self.residual.len(), 1);
        if self.fits("a residual", value.shape(), expected) {
            for (entry, given) in self.residual.iter_mut().zip(value.iter()) {
                *entry = *given;
            }
        }
    }

    /// Writes the derivative of the whitened residual by the step of its `slot`-th variable,
    /// counted as in [`Residual::variables`].
    pub fn jacobian<R: Dim, C: Dim, S: Storage<f64, R, C>>(
        &mut self,
        slot: usize,
        block: &Matrix<f64, R, C, S>,
    ) {
        let rows = self.residual.len();
        let (Some(&start), Some(&end)) = (self.starts.get(slot), self.starts.get(slot + 1)) else {
            self.fits("a Jacobian block of one variable too many", block.shape(), (rows, 0));
            return;
        };
        if self.fits("a Jacobian block", block.shape(), (rows, end - start)) {
            for (column, given) in (start..end).zip(block.column_iter()) {
                for (entry, given) in self.jacobian.column_mut(column).iter_mut().zip(given.iter())
                {
                    *entry = *given;
                }
            }
        }
    }

    fn fits(
        &mut self,
        what: &'static str,
        given: (usize, usize),
        expected: (usize, usize),
    ) -> bool {
        if given != expected {
            self.misfit =
                Some(SolveError::WrongShape { residual: self.index, what, given, expected });
        }
        given == expected
    }

    /// What did not fit, if anything.
    pub(super) fn misfit(self) -> Option<SolveError> {
        self.misfit
    }
}
