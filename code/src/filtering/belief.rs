//! Estimates, and how uncertain they are together.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::{Correction, CorrectionError, Form, correct};
use crate::consistency::Chart;
use crate::inertial::NavState;
use crate::least_squares::{Key, Manifold, Values};

// ANCHOR: belief
/// What is believed of some variables: an estimate of each, and the covariance of their errors.
#[derive(Debug, Clone, Default)]
pub struct Belief {
    values: Values,
    covariance: DMatrix<f64>,
    /// Directions that go along, a column each.
    directions: DMatrix<f64>,
}
// ANCHOR_END: belief

impl Belief {
    /// Nothing is believed of anything.
    pub fn new() -> Self {
        Self::default()
    }

    // ANCHOR: add
    /// Adds a variable whose error is independent of all others. `covariance` is that of its
    /// error, a square matrix of its dimension.
    ///
    /// # Errors
    ///
    /// [`BeliefError::Covariance`] when it is not a finite matrix of that size.
    pub fn add<V: Manifold>(
        &mut self,
        value: V,
        covariance: &DMatrix<f64>,
    ) -> Result<Key<V>, BeliefError> {
        let (before, own) = (self.dimension(), value.dimension());
        check(covariance.shape(), (own, own), covariance.iter())?;
        self.resize(before + own);
        self.covariance.view_mut((before, before), (own, own)).copy_from(covariance);
        Ok(self.values.add(value))
    }
    // ANCHOR_END: add

    /// Says that the errors of two stretches of coordinates vary together: their covariance, with a
    /// row for each from the first coordinate on and a column for each from the second.
    pub(crate) fn tie(&mut self, (first, second): (usize, usize), covariance: &DMatrix<f64>) {
        self.covariance.view_mut((first, second), covariance.shape()).copy_from(covariance);
        let transposed = covariance.transpose();
        self.covariance.view_mut((second, first), transposed.shape()).copy_from(&transposed);
    }

    /// Adds a variable that is a function of the others, but for noise of its own. `by_all` has the
    /// derivatives of its error by theirs, with a row for each of its coordinates and a column for
    /// each of theirs; `noise` is the covariance of the rest. Implements {eq:cloned-covariance}.
    ///
    /// # Errors
    ///
    /// [`BeliefError::Covariance`] when a matrix is not finite or not of that size.
    // ANCHOR: add_function
    pub fn add_function<V: Manifold>(
        &mut self,
        value: V,
        by_all: &DMatrix<f64>,
        noise: &DMatrix<f64>,
    ) -> Result<Key<V>, BeliefError> {
        let (before, own) = (self.dimension(), value.dimension());
        check(by_all.shape(), (own, before), by_all.iter())?;
        check(noise.shape(), (own, own), noise.iter())?;
        let with_all = by_all * &self.covariance;
        let with_itself = &with_all * by_all.transpose() + noise;
        let with_itself = 0.5 * (&with_itself + with_itself.transpose());
        self.resize(before + own);
        let covariance = &mut self.covariance;
        covariance.view_mut((before, 0), (own, before)).copy_from(&with_all);
        covariance.view_mut((0, before), (before, own)).copy_from(&with_all.transpose());
        covariance.view_mut((before, before), (own, own)).copy_from(&with_itself);
        let along = by_all * self.directions.rows(0, before);
        self.directions.rows_mut(before, own).copy_from(&along);
        Ok(self.values.add(value))
    }
    // ANCHOR_END: add_function

    // ANCHOR: clone_variable
    /// Adds a second copy of a variable, which stays where it is when the first one moves on:
    /// stochastic cloning [@roumeliotis2002].
    ///
    /// # Errors
    ///
    /// [`BeliefError::NoSuchVariable`].
    pub fn clone_variable<V: Manifold>(&mut self, variable: Key<V>) -> Result<Key<V>, BeliefError> {
        let missing = || self.no_such(variable.index());
        let variable = self.values.key::<V>(variable.index()).ok_or_else(missing)?;
        let value = self.values.get(variable).ok_or_else(missing)?.clone();
        let coordinates = self.values.coordinates_of(variable.index()).ok_or_else(missing)?;
        let own = coordinates.len();
        let mut by_all = DMatrix::zeros(own, self.dimension());
        by_all.columns_range_mut(coordinates).fill_with_identity();
        self.add_function(value, &by_all, &DMatrix::zeros(own, own))
    }
    // ANCHOR_END: clone_variable

    // ANCHOR: keep
    /// Keeps some variables, by number and in this order, and drops the others. What is believed of
    /// those that stay does not change: the marginal of a Gaussian is a block of its covariance.
    /// Keys from before name other variables then, or none: take new ones from [`Values::key`].
    ///
    /// # Errors
    ///
    /// [`BeliefError::NoSuchVariable`]; nothing is dropped then.
    pub fn keep(&mut self, variables: &[usize]) -> Result<(), BeliefError> {
        let count = self.values.len();
        let missing = variables.iter().find(|variable| **variable >= count);
        if let Some(variable) = missing {
            return Err(self.no_such(*variable));
        }
        let coordinates = |variable: &usize| self.values.coordinates_of(*variable);
        let kept: Vec<usize> = variables.iter().filter_map(coordinates).flatten().collect();
        self.values = self.values.select(variables).unwrap_or_default();
        self.covariance = self.covariance.select_rows(&kept).select_columns(&kept);
        self.directions = self.directions.select_rows(&kept);
        Ok(())
    }
    // ANCHOR_END: keep

    // ANCHOR: correct_belief
    /// Corrects the estimates and their covariance by a whitened linear measurement; see
    /// [`correct`]. The covariance stays one of steps from the old estimates: carrying it to the new
    /// ones, {eq:moved-covariance}, is left to [`Belief::update`], because filters whose derivatives
    /// are taken at first estimates must not do it.
    ///
    /// # Errors
    ///
    /// A [`CorrectionError`]; the belief then stays as it was.
    pub fn correct(
        &mut self,
        jacobian: &DMatrix<f64>,
        residual: &DVector<f64>,
        form: Form,
    ) -> Result<Correction, CorrectionError> {
        let correction = correct(&mut self.covariance, jacobian, residual, form)?;
        self.values = self.values.retract(correction.step.as_slice());
        Ok(correction)
    }
    // ANCHOR_END: correct_belief

    /// The same, but the values are retracted as a chart does it, about the state `body`, and what
    /// stays as it was is the error in the chart: the covariance is carried to the new estimates.
    ///
    /// # Errors
    ///
    /// A [`CorrectionError`]; the belief then stays as it was.
    ///
    /// # Panics
    ///
    /// When the belief has no state with the key `body`.
    // ANCHOR: correct_on_chart
    pub fn correct_on_chart(
        &mut self,
        (chart, body): (Chart, Key<NavState>),
        jacobian: &DMatrix<f64>,
        residual: &DVector<f64>,
        form: Form,
    ) -> Result<Correction, CorrectionError> {
        if chart == Chart::Separate {
            return self.correct(jacobian, residual, form);
        }
        let mut covariance = self.covariance.clone();
        let correction = correct(&mut covariance, jacobian, residual, form)?;
        let moved = chart.retract(&self.values, body, correction.step.as_slice());
        let transport = chart.transport((&self.values, &moved), body);
        let transport = transport.ok_or(CorrectionError::Covariance)?;
        transport.carry(&mut covariance);
        transport.apply(&mut self.directions);
        (self.values, self.covariance) = (moved, covariance);
        Ok(correction)
    }
    // ANCHOR_END: correct_on_chart

    /// The estimates.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Gives a variable another estimate, and leaves the covariance. False, and nothing happens, when
    /// there is none of its kind and place, or of another dimension: see [`Values::set`].
    pub fn set<V: Manifold>(&mut self, variable: Key<V>, value: V) -> bool {
        self.values.set(variable, value)
    }

    /// The covariance of all errors, in the order of the variables.
    pub fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }

    /// The covariance of the error of one variable, or `None` when the variable of that number is of
    /// another kind or does not exist.
    pub fn of<V: Manifold>(&self, variable: Key<V>) -> Option<DMatrix<f64>> {
        let known = self.values.key::<V>(variable.index())?;
        let own = self.values.coordinates_of(known.index())?;
        Some(self.covariance.view_range(own.clone(), own).into_owned())
    }

    /// How many numbers all errors have together.
    pub fn dimension(&self) -> usize {
        self.values.dimension()
    }

    // ANCHOR: follow
    /// Follows directions of the errors, a column each: from now on each goes where an error of the
    /// same coordinates would go, through transitions, copies and functions. Nothing is believed of
    /// them.
    ///
    /// # Errors
    ///
    /// [`BeliefError::Covariance`] when there is not a finite row for each coordinate.
    pub fn follow(&mut self, directions: DMatrix<f64>) -> Result<(), BeliefError> {
        let expected = (self.dimension(), directions.ncols());
        check(directions.shape(), expected, directions.iter())?;
        self.directions = directions;
        Ok(())
    }

    /// Where the directions have come that are followed.
    pub fn directions(&self) -> &DMatrix<f64> {
        &self.directions
    }
    // ANCHOR_END: follow

    pub(crate) fn parts(&mut self) -> (&mut Values, [&mut DMatrix<f64>; 2]) {
        (&mut self.values, [&mut self.covariance, &mut self.directions])
    }

    fn resize(&mut self, dimension: usize) {
        let covariance = std::mem::take(&mut self.covariance);
        self.covariance = covariance.resize(dimension, dimension, 0.0);
        let directions = std::mem::take(&mut self.directions);
        let columns = directions.ncols();
        self.directions = directions.resize(dimension, columns, 0.0);
    }

    fn no_such(&self, variable: usize) -> BeliefError {
        BeliefError::NoSuchVariable { variable, variables: self.values.len() }
    }
}

/// Whether a matrix has a size, and entries that are finite.
fn check<'a>(
    given: (usize, usize),
    expected: (usize, usize),
    mut entries: impl Iterator<Item = &'a f64>,
) -> Result<(), BeliefError> {
    let fits = given == expected && entries.all(|entry| entry.is_finite());
    fits.then_some(()).ok_or(BeliefError::Covariance { given, expected })
}

/// Why a variable cannot be believed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum BeliefError {
    /// A key or number is that of other variables.
    #[error("variable {variable} is not one of the {variables} that are believed in; add it first")]
    NoSuchVariable {
        /// The number given.
        variable: usize,
        /// How many there are.
        variables: usize,
    },
    /// A matrix has the wrong size, or an entry that is not finite.
    #[error(
        "a matrix of {} rows and {} columns was given; give finite numbers in {} rows and {} \
         columns", given.0, given.1, expected.0, expected.1
    )]
    Covariance {
        /// Rows and columns given.
        given: (usize, usize),
        /// Rows and columns that it should have.
        expected: (usize, usize),
    },
}
