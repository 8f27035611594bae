//! What an interval of readings does to a state and its biases, and to their errors.

use nalgebra::{SVector, Vector3};
use thiserror::Error;

use super::Belief;
use crate::inertial::{ImuBias, NavState};
use crate::least_squares::Key;
use crate::preintegration::{CombinedPreintegrated, Matrix15, linearize};

// ANCHOR: transition
/// How a state and its biases come out of an interval of readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// The state at the end. The biases stay.
    pub state: NavState,
    /// The 15×15 matrix Φ that takes the errors of state and biases at the beginning to those at
    /// the end.
    pub by_error: Matrix15,
    /// The 15×15 covariance Q of what the noise of the readings and the walk of the biases add.
    pub noise: Matrix15,
}
// ANCHOR_END: transition

impl Transition {
    /// The transition from a state and a bias over readings that were summed up at that bias or
    /// near it. `gravity` is that of the world, in m/s².
    ///
    /// # Errors
    ///
    /// [`TransitionError`] when a number is not finite.
    pub fn new(
        readings: &CombinedPreintegrated,
        state: &NavState,
        bias: &ImuBias,
        gravity: &Vector3<f64>,
    ) -> Result<Self, TransitionError> {
        let second = readings.sums.predict(state, gravity, bias);
        Self::between((state, &second), readings, bias, gravity)
    }

    /// The transition to the second of two states, with derivatives at both. The first need not be
    /// the state from which the second was predicted: it may be an earlier estimate of it, so that
    /// what was once free stays free.
    ///
    /// The residual of the interval, r(x, b, y), is zero at the prediction y. Its derivatives there
    /// say how an error of y follows from those of x and b: {eq:residual-by-first},
    /// {eq:residual-by-second} and {eq:residual-by-bias}, divided by one another. Implements
    /// {eq:transition} and {eq:transition-noise}.
    ///
    /// # Errors
    ///
    /// As those of [`Transition::new`].
    // ANCHOR: between
    pub fn between(
        (first, second): (&NavState, &NavState),
        readings: &CombinedPreintegrated,
        bias: &ImuBias,
        gravity: &Vector3<f64>,
    ) -> Result<Self, TransitionError> {
        let linear = linearize(&readings.sums, first, second, gravity, bias);
        let inverse = linear.by_second.try_inverse().ok_or(TransitionError::NotFinite)?;
        let mut by_error = Matrix15::identity();
        by_error.fixed_view_mut::<9, 9>(0, 0).copy_from(&(-inverse * linear.by_first));
        by_error.fixed_view_mut::<9, 6>(0, 9).copy_from(&(-inverse * linear.by_bias));
        let mut unwhitened = Matrix15::identity();
        unwhitened.fixed_view_mut::<9, 9>(0, 0).copy_from(&inverse);
        let noise = unwhitened * readings.covariance() * unwhitened.transpose();
        let is_finite = by_error.iter().chain(&noise).all(|number| number.is_finite());
        let transition = Self { state: *second, by_error, noise };
        is_finite.then_some(transition).ok_or(TransitionError::NotFinite)
    }
    // ANCHOR_END: between
}

impl Belief {
    // ANCHOR: carry_on
    /// Carries a state and its biases over an interval. All other variables stay where they are,
    /// and as tied to these as the transition leaves them. Implements {eq:carried-covariance}.
    ///
    /// # Errors
    ///
    /// [`TransitionError::NoSuchVariable`].
    pub fn carry_on(
        &mut self,
        (state, bias): (Key<NavState>, Key<ImuBias>),
        transition: &Transition,
    ) -> Result<(), TransitionError> {
        let (missing, values) = (TransitionError::NoSuchVariable, self.values());
        let named = (values.key::<NavState>(state.index()), values.key::<ImuBias>(bias.index()));
        let (Some(state), Some(bias)) = named else { return Err(missing) };
        let own = |index| values.coordinates_of(index).ok_or(missing);
        let places: [usize; 15] = {
            let (state, bias) = (own(state.index())?, own(bias.index())?);
            let mut places = state.chain(bias);
            std::array::from_fn(|_| places.next().unwrap_or(0))
        };
        let (values, [covariance, directions]) = self.parts();
        if !values.set(state, transition.state) {
            return Err(missing);
        }
        let Transition { by_error, noise, .. } = transition;
        for mut direction in directions.column_iter_mut() {
            let before = SVector::<f64, 15>::from_fn(|row, _| direction[places[row]]);
            let after = by_error * before;
            places.iter().zip(&after).for_each(|(place, after)| direction[*place] = *after);
        }
        let before = Matrix15::from_fn(|row, column| covariance[(places[row], places[column])]);
        let after = by_error * before * by_error.transpose() + noise;
        for other in (0..covariance.ncols()).filter(|column| !places.contains(column)) {
            let tied = SVector::<f64, 15>::from_fn(|row, _| covariance[(places[row], other)]);
            for (place, tie) in places.iter().zip(&(by_error * tied)) {
                covariance[(*place, other)] = *tie;
                covariance[(other, *place)] = *tie;
            }
        }
        for (row, column) in (0..15).flat_map(|row| (0..15).map(move |column| (row, column))) {
            let mean = 0.5 * (after[(row, column)] + after[(column, row)]);
            covariance[(places[row], places[column])] = mean;
        }
        Ok(())
    }
    // ANCHOR_END: carry_on
}

/// Why a belief cannot be carried over an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TransitionError {
    /// A derivative or a variance is not finite.
    #[error(
        "the transition is not finite; the state, the bias or gravity is NaN, or a number is too large"
    )]
    NotFinite,
    /// A key is that of other variables.
    #[error("the state or its bias is not one of the variables; add them first")]
    NoSuchVariable,
}
