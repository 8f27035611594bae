//! How sure an estimate is.

use nalgebra::DMatrix;

use super::group::Point;
use super::landmarks::{LandmarkElimination, Singular};
use super::normal_equations::Dense;
use super::{Key, LinearSystem, Manifold, Problem, SolveError, Values};

// ANCHOR: covariance
/// The covariance of an estimate, by variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    parts: Vec<Part>,
    /// By column, the first of the parts that has it.
    part_of: Vec<usize>,
    /// By variable, its columns: none when it is held.
    columns: Vec<Vec<usize>>,
}

/// The covariance of some columns together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    /// Ascending.
    pub(super) columns: Vec<usize>,
    pub(super) matrix: DMatrix<f64>,
}
// ANCHOR_END: covariance

impl Part {
    /// Where columns stand in it; `None` when one does not.
    fn places(&self, columns: &[usize]) -> Option<Vec<usize>> {
        columns.iter().map(|column| self.columns.binary_search(column).ok()).collect()
    }
}

impl Covariance {
    /// Of parts that hold every column, by variable.
    pub(super) fn of_parts(parts: Vec<Part>, columns: Vec<Vec<usize>>) -> Self {
        let count = parts.iter().filter_map(|part| part.columns.last()).max().map_or(0, |c| c + 1);
        let mut part_of = vec![0; count];
        for (number, part) in parts.iter().enumerate().rev() {
            part.columns.iter().for_each(|column| part_of[*column] = number);
        }
        Self { parts, part_of, columns }
    }

    /// The covariance of all variables that were solved for together. Of a dense system it has the
    /// columns of [`Problem::columns`]; with landmarks eliminated, `D` for each of
    /// [`LandmarkElimination::rows`](super::LandmarkElimination::rows); of fronts, those of the last.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.parts[0].matrix
    }

    /// The covariance of one variable, whatever the others are: its *marginal*. It has a row for
    /// each coordinate that is not held. `None` when there is no such variable or all are.
    pub fn of<V: Manifold>(&self, variable: Key<V>) -> Option<DMatrix<f64>> {
        self.of_number(variable.index())
    }

    /// The same of a variable of any kind, by number.
    pub fn of_number(&self, variable: usize) -> Option<DMatrix<f64>> {
        self.between_numbers(variable, variable)
    }

    /// The covariance between two variables, with the rows of the first and the columns of the
    /// second. `None` when one does not exist or does not move, or when they never met in the
    /// elimination: a landmark that was eliminated and anything else, two variables that no front
    /// has together.
    pub fn between<V: Manifold, W: Manifold>(
        &self,
        first: Key<V>,
        second: Key<W>,
    ) -> Option<DMatrix<f64>> {
        self.between_numbers(first.index(), second.index())
    }

    /// The same of variables of any kind, by number.
    pub fn between_numbers(&self, first: usize, second: usize) -> Option<DMatrix<f64>> {
        let columns = |index| self.columns.get(index).filter(|own: &&Vec<usize>| !own.is_empty());
        let (rows, columns) = (columns(first)?, columns(second)?);
        [rows[0], columns[0]].into_iter().find_map(|column| {
            let part = &self.parts[self.part_of[column]];
            let (rows, columns) = part.places(rows).zip(part.places(columns))?;
            Some(part.matrix.select_rows(&rows).select_columns(&columns))
        })
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
        let matrix = &inverse * inverse.transpose();
        let part = Part { columns: (0..columns.count).collect(), matrix };
        let coordinates = |index| problem.values().coordinates_of(index).unwrap_or_default();
        let own = |index| columns.select(coordinates(index));
        Ok(Self::of_parts(vec![part], (0..problem.values().len()).map(own).collect()))
    }
}

impl<const D: usize, const C: usize> LandmarkElimination<D, C> {
    /// The covariance of all variables at the point that was linearized last, from that of those
    /// that have rows: `D` rows and columns for each of [`LandmarkElimination::rows`].
    ///
    /// # Errors
    ///
    /// [`Singular`] when a landmark is free.
    pub fn with_landmarks(
        &mut self,
        problem: &Problem,
        matrix: DMatrix<f64>,
    ) -> Result<Covariance, Singular> {
        let mut landmarks = self.landmark_covariances(&matrix)?.into_iter();
        let mut start = matrix.nrows();
        let mut parts = vec![Part { columns: (0..start).collect(), matrix }];
        let mut of_variable = Vec::new();
        let columns = problem.columns();
        for (variable, first) in self.firsts(problem).into_iter().enumerate() {
            let coordinates = problem.values().coordinates_of(variable).unwrap_or_default();
            let moving = columns.of[coordinates].iter().enumerate().filter(|(_, c)| c.is_some());
            let axes = moving.map(|(axis, _)| axis);
            let own: Vec<usize> = axes.map(|axis| first.unwrap_or(start) + axis).collect();
            if first.is_none() && !own.is_empty() {
                let matrix = landmarks.next().unwrap_or_default();
                let matrix = DMatrix::from_column_slice(3, 3, matrix.as_slice());
                start += own.len();
                parts.push(Part { columns: own.clone(), matrix });
            }
            of_variable.push(own);
        }
        Ok(Covariance::of_parts(parts, of_variable))
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
    /// [`SolveError::Singular`] when some direction is not determined, [`SolveError::NullSpace`] when that
    /// cannot be said, and those of [`Problem::linearize`].
    pub fn covariance(&self, values: &Values) -> Result<Covariance, SolveError> {
        self.covariance_with(Dense::new(self)?, values)
    }

    /// The same with another linear system than the dense one, which may not know how all pairs of
    /// variables vary together; see [`Covariance::between`].
    ///
    /// # Errors
    ///
    /// As those of [`Problem::covariance`], and [`SolveError::LostToRounding`] where the dense system would
    /// still have an answer.
    pub fn covariance_with(
        &self,
        mut system: impl LinearSystem,
        values: &Values,
    ) -> Result<Covariance, SolveError> {
        self.check_values(values)?;
        self.at(values, |at| system.covariance(self, at))
    }
}
