//! How sure an estimate is.

use nalgebra::DMatrix;

use super::null_space::SingularSystem;
use super::{Columns, Key, Manifold, Problem, SolveError, Values};

// ANCHOR: covariance
/// The covariance of an estimate, by variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    matrix: DMatrix<f64>,
    columns: Columns,
    /// First coordinate of each variable, and the number of all.
    starts: Vec<usize>,
}
// ANCHOR_END: covariance

impl Covariance {
    /// The covariance of all columns together; see [`Problem::columns`].
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// The covariance of one variable, whatever the others are: its *marginal*. It has a row for
    /// each coordinate that is not held. `None` when there is no such variable or all are.
    pub fn of<V: Manifold>(&self, variable: Key<V>) -> Option<DMatrix<f64>> {
        self.between(variable, variable)
    }

    /// The covariance between two variables, with the rows of the first and the columns of the
    /// second. `None` when one does not exist or does not move.
    pub fn between<V: Manifold, W: Manifold>(
        &self,
        first: Key<V>,
        second: Key<W>,
    ) -> Option<DMatrix<f64>> {
        let rows = self.columns_of(first.index())?;
        let columns = self.columns_of(second.index())?;
        Some(self.matrix.select_rows(&rows).select_columns(&columns))
    }

    fn columns_of(&self, index: usize) -> Option<Vec<usize>> {
        let coordinates = *self.starts.get(index)?..*self.starts.get(index + 1)?;
        Some(self.columns.select(coordinates)).filter(|columns| !columns.is_empty())
    }
}

impl Problem {
    /// The covariance of the estimate `values`: the inverse of the Hessian there, from the triangle
    /// of the Jacobian. Implements {eq:estimate-covariance}.
    ///
    /// It is the covariance to first order, under four conditions: `values` minimize the cost, the
    /// whitened noise has unit covariance and is independent between factors, the model is nearly
    /// linear over the spread, and no kernel weighs anything down. It is not scaled by the
    /// residuals that are left. Each variable's part is that of its `retract` step.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`] when some direction is not determined, and those of
    /// [`Problem::linearize`].
    pub fn covariance(&self, values: &Values) -> Result<Covariance, SolveError> {
        let columns = self.columns();
        if columns.count == 0 {
            return Err(SolveError::NothingFree);
        }
        if let Some(singular) = self.null_space(values)?.singular() {
            return Err(singular.into());
        }
        let (jacobian, _) = self.jacobian(values)?;
        let triangle = jacobian.qr().unpack_r();
        let size = columns.count;
        let inverse = triangle.solve_upper_triangular(&DMatrix::identity(size, size));
        let everything = || SingularSystem::everything(size);
        let inverse = inverse.ok_or_else(|| SolveError::Singular(everything()))?;
        let coordinates = (0..values.len()).filter_map(|index| values.coordinates_of(index));
        let starts = coordinates.map(|range| range.start).chain([values.dimension()]).collect();
        Ok(Covariance { matrix: &inverse * inverse.transpose(), columns, starts })
    }
}
