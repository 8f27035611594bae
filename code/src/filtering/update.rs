//! The update of a belief by any factors, iterated where they bend.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::{Belief, Correction, CorrectionError, Form, correct};
use crate::least_squares::{Problem, SolveError, Values};

// ANCHOR: update_options
/// How a belief is updated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UpdateOptions {
    /// How often, at most, the measurements are linearized. Once is the extended Kalman filter;
    /// zero counts as once.
    pub iterations: usize,
    /// The iteration ends when no coordinate moves by more than this part of its standard
    /// deviation.
    pub tolerance: f64,
    /// How the covariance is computed.
    pub form: Form,
    /// The largest normalized innovation squared that is believed: a quantile of the chi-square
    /// distribution with as many degrees of freedom as there are rows.
    pub gate: Option<f64>,
}

impl Default for UpdateOptions {
    fn default() -> Self {
        Self { iterations: 1, tolerance: 1e-6, form: Form::Difference, gate: None }
    }
}
// ANCHOR_END: update_options

/// What an update did.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// rᵀ S⁻¹ r before the update, not divided by the number of rows.
    pub innovation: f64,
    /// How many numbers the measurements have.
    pub rows: usize,
    /// How often they were linearized.
    pub iterations: usize,
    /// By which part of its standard deviation the coordinate that moved most was moved by the last
    /// step.
    pub last_step: f64,
}

impl Belief {
    // ANCHOR: update
    /// Updates the belief by the factors of a problem of the same variables, wherever they begin
    /// there. What the problem holds its factors take for exact; what it ties is not tied here.
    ///
    /// Each iteration is a step of Gauss and Newton for the factors together with the belief, taken
    /// at the estimates that the last one found [@bell1993]. Implements {eq:iterated-step}. The covariance is that of the last linearization,
    /// of errors of the estimates that it led to.
    ///
    /// # Errors
    ///
    /// An [`UpdateError`]; the belief then stays as it was.
    pub fn update(
        &mut self,
        measurements: &Problem,
        options: &UpdateOptions,
    ) -> Result<Update, UpdateError> {
        let prior = self.values().clone();
        let mut values = prior.clone();
        let (mut innovation, mut iterations) = (None, 0);
        loop {
            iterations += 1;
            let moved = Moved::new(&prior, &values);
            let (jacobian, residual) = moved.linearized(measurements, &values)?;
            let mut covariance = self.covariance().clone();
            let Correction { step, innovation: squared } =
                correct(&mut covariance, &jacobian, &residual, options.form)?;
            let innovation = *innovation.get_or_insert(squared);
            if let Some(limit) = options.gate.filter(|limit| limit.is_nan() || innovation > *limit)
            {
                return Err(UpdateError::Gated { innovation, limit });
            }
            let step = moved.back(step);
            values = values.retract(step.as_slice());
            let last_step = self.largest(&step);
            if last_step <= options.tolerance || iterations >= options.iterations {
                let moved = Moved::new(&prior, &values);
                moved.reset(&mut covariance);
                let (own, [own_covariance, directions]) = self.parts();
                moved.carry(directions);
                (*own, *own_covariance) = (values, covariance);
                let rows = residual.len();
                return Ok(Update { innovation, rows, iterations, last_step });
            }
        }
    }
    // ANCHOR_END: update

    /// The largest part of its standard deviation by which a step moves a coordinate.
    fn largest(&self, step: &DVector<f64>) -> f64 {
        let variances = self.covariance().diagonal();
        let parts = step
            .iter()
            .zip(&variances)
            .map(|(step, variance)| if *step == 0.0 { 0.0 } else { step.abs() / variance.sqrt() });
        parts.fold(0.0, f64::max)
    }
}

// ANCHOR: moved
/// How far values have moved from those of a belief: the step d between them, and for each variable
/// the inverse of the derivative D of that step by a further one.
struct Moved {
    step: DVector<f64>,
    inverse: Vec<(Range<usize>, DMatrix<f64>)>,
}
// ANCHOR_END: moved

impl Moved {
    fn new(from: &Values, to: &Values) -> Self {
        let inverse = (0..from.len()).filter_map(|variable| {
            let coordinates = from.coordinates_of(variable)?;
            let mut derivative = DMatrix::zeros(coordinates.len(), coordinates.len());
            from.local_jacobian_to(variable, (to, variable), derivative.as_mut_slice())?;
            Some((coordinates, derivative.try_inverse()?))
        });
        Self { step: DVector::from_vec(from.local(to)), inverse: inverse.collect() }
    }

    // ANCHOR: linearized
    /// The derivatives of measurements by the error of the belief, and what they leave of the
    /// residual where that error is zero.
    fn linearized(
        &self,
        measurements: &Problem,
        values: &Values,
    ) -> Result<(DMatrix<f64>, DVector<f64>), UpdateError> {
        let (mut jacobian, residual) = measurements.jacobian_by_coordinates(values)?;
        for (coordinates, inverse) in &self.inverse {
            let own = jacobian.columns_range(coordinates.clone()) * inverse;
            jacobian.columns_range_mut(coordinates.clone()).copy_from(&own);
        }
        let residual = residual - &jacobian * &self.step;
        Ok((jacobian, residual))
    }
    // ANCHOR_END: linearized

    /// The step from where the values are, of an error of the belief.
    fn back(&self, mut error: DVector<f64>) -> DVector<f64> {
        error -= &self.step;
        for (coordinates, inverse) in &self.inverse {
            let own = inverse * error.rows_range(coordinates.clone());
            error.rows_range_mut(coordinates.clone()).copy_from(&own);
        }
        error
    }

    // ANCHOR: reset
    /// Turns the covariance of the error of the belief into that of the values it has moved to.
    fn reset(&self, covariance: &mut DMatrix<f64>) {
        self.carry(covariance);
        covariance.transpose_mut();
        self.carry(covariance);
    }

    /// Turns errors of the belief, a column each, into those of the values it has moved to.
    fn carry(&self, errors: &mut DMatrix<f64>) {
        for (coordinates, inverse) in &self.inverse {
            let rows = inverse * errors.rows_range(coordinates.clone());
            errors.rows_range_mut(coordinates.clone()).copy_from(&rows);
        }
    }
    // ANCHOR_END: reset
}

/// Why a belief cannot be updated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum UpdateError {
    /// The measurements cannot be linearized where the estimates are, or have other variables.
    #[error(transparent)]
    Measurements(#[from] SolveError),
    /// The covariance cannot be corrected.
    #[error(transparent)]
    Correction(#[from] CorrectionError),
    /// The measurements contradict the belief.
    #[error(
        "the normalized innovation squared is {innovation:.1}, above the gate of {limit:.1}; leave \
         the measurement out, or believe less"
    )]
    Gated {
        /// rᵀ S⁻¹ r.
        innovation: f64,
        /// The largest that is believed.
        limit: f64,
    },
}
