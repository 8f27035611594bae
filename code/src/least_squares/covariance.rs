//! How sure an estimate is.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, Matrix3};

use super::group::Point;
use super::landmarks::{LandmarkElimination, Singular};
use super::normal_equations::Dense;
use super::{Key, LinearSystem, Manifold, Problem, SolveError, Values};

// ANCHOR: covariance
/// The covariance of an estimate, by variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    matrix: DMatrix<f64>,
    /// By variable, its rows in the matrix: none when it is held or was eliminated.
    rows: Vec<Vec<usize>>,
    /// By variable, the covariance of each landmark that was eliminated.
    landmarks: BTreeMap<usize, Matrix3<f64>>,
}
// ANCHOR_END: covariance

impl Covariance {
    /// The covariance of all variables together. Of a dense system it has the columns of
    /// [`Problem::columns`]; with landmarks eliminated, `D` for each of
    /// [`LandmarkElimination::rows`].
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// The covariance of one variable, whatever the others are: its *marginal*. It has a row for
    /// each coordinate that is not held. `None` when there is no such variable or all are.
    pub fn of<V: Manifold>(&self, variable: Key<V>) -> Option<DMatrix<f64>> {
        let landmark = self.landmarks.get(&variable.index());
        let whole = |own: &Matrix3<f64>| DMatrix::from_column_slice(3, 3, own.as_slice());
        landmark.map(whole).or_else(|| self.between(variable, variable))
    }

    /// The covariance between two variables, with the rows of the first and the columns of the
    /// second. `None` when one does not exist, does not move or is a landmark that was eliminated.
    pub fn between<V: Manifold, W: Manifold>(
        &self,
        first: Key<V>,
        second: Key<W>,
    ) -> Option<DMatrix<f64>> {
        let rows = |index| self.rows.get(index).filter(|rows: &&Vec<usize>| !rows.is_empty());
        let (rows, columns) = (rows(first.index())?, rows(second.index())?);
        Some(self.matrix.select_rows(rows).select_columns(columns))
    }

    /// That of all variables, from the triangle of the Jacobian.
    pub(super) fn dense(problem: &Problem, at: Point) -> Result<Self, SolveError> {
        let null_space = problem.null_space_at(at)?;
        let columns = problem.columns();
        let (jacobian, _) = problem.jacobian_at(at, &columns)?;
        let identity = DMatrix::identity(columns.count, columns.count);
        let regular = (null_space.nullity() == 0).then(|| jacobian.qr().unpack_r());
        let inverse = regular.and_then(|triangle| triangle.solve_upper_triangular(&identity));
        let inverse = inverse.ok_or_else(|| null_space.undetermined())?;
        let coordinates = |index| problem.values().coordinates_of(index).unwrap_or_default();
        let own = |index| columns.select(coordinates(index));
        let rows = (0..problem.values().len()).map(own).collect();
        Ok(Self { matrix: &inverse * inverse.transpose(), rows, landmarks: BTreeMap::new() })
    }
}

impl<const D: usize> LandmarkElimination<D> {
    /// The covariance of all variables at the point that was linearized last, from that of those
    /// that have rows.
    ///
    /// # Errors
    ///
    /// [`Singular`] when a landmark is free.
    pub fn with_landmarks(
        &mut self,
        problem: &Problem,
        matrix: DMatrix<f64>,
    ) -> Result<Covariance, Singular> {
        let mut each = self.landmark_covariances(&matrix)?.into_iter();
        let columns = problem.columns();
        let (mut rows, mut landmarks) = (Vec::new(), BTreeMap::new());
        for (variable, row) in self.rows(problem).into_iter().enumerate() {
            let coordinates = problem.values().coordinates_of(variable).unwrap_or_default();
            let moving = columns.of[coordinates].iter().enumerate().filter(|(_, c)| c.is_some());
            let axes: Vec<usize> = moving.map(|(axis, _)| axis).collect();
            if row.is_none() && !axes.is_empty() {
                landmarks.extend(each.next().map(|own| (variable, own)));
            }
            let places = |row: usize| axes.iter().map(|axis| D * row + axis).collect();
            rows.push(row.map_or_else(Vec::new, places));
        }
        Ok(Covariance { matrix, rows, landmarks })
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
        self.check_values(values)?;
        let mut system = Dense::new(self)?;
        self.at(values, |at| system.covariance(self, at))
    }
}
