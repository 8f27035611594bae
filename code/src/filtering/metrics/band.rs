//! Between which values a consistent estimator's mean errors lie.

use thiserror::Error;

use crate::filtering::chi_square_band;

// ANCHOR: nees_band
/// Where the mean of [`nees`](super::nees) lies when the estimator is consistent, on both sides of
/// one: below the band its covariances are too large, above it too small.
///
/// The mean is one over independent runs, at a time that was stated before the runs. With N runs of
/// d numbers each, N d times the mean follows chi-square with N d degrees of freedom. The steps of
/// one run are no substitute for runs: their errors depend on one another, so that their mean
/// scatters more than this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeesBand {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}
// ANCHOR_END: nees_band

impl NeesBand {
    // ANCHOR: one_test
    /// For one test that was stated beforehand. A consistent estimator is outside with the probability
    /// `outside`, half of it on either side.
    ///
    /// # Errors
    ///
    /// [`BandError`] without runs or numbers, and for a probability that leaves no band.
    pub fn new(runs: usize, dimension: usize, outside: f64) -> Result<Self, BandError> {
        let degrees = runs.saturating_mul(dimension);
        if degrees == 0 {
            return Err(BandError::Empty { runs, dimension });
        }
        if !(outside > 2.0 * f64::EPSILON && outside < 1.0) {
            return Err(BandError::Outside { outside });
        }
        let band = chi_square_band(outside, degrees).map_err(|_| BandError::Outside { outside })?;
        let [low, high] = band.map(|end| end / degrees as f64);
        Ok(Self { low, high })
    }
    // ANCHOR_END: one_test

    // ANCHOR: family
    /// For a family of tests on the same runs, one for each of the dimensions: some part of the state
    /// at some time. A consistent estimator is outside any of them with at most the probability
    /// `outside`.
    ///
    /// Each test gets an equal share of it, as Bonferroni has it. Šidák's share, a little larger, is
    /// right for tests that do not depend on one another; parts of one state and times of one run do.
    /// Implements {eq:nees-band}.
    ///
    /// # Errors
    ///
    /// Those of [`NeesBand::new`].
    pub fn family(runs: usize, dimensions: &[usize], outside: f64) -> Result<Vec<Self>, BandError> {
        if !(outside > 0.0 && outside < 1.0) {
            return Err(BandError::Outside { outside });
        }
        let share = outside / dimensions.len() as f64;
        dimensions.iter().map(|dimension| Self::new(runs, *dimension, share)).collect()
    }
    // ANCHOR_END: family

    /// Whether a mean lies in the band.
    pub fn contains(&self, mean: f64) -> bool {
        self.low <= mean && mean <= self.high
    }
}

/// Why there is no band.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum BandError {
    /// There is nothing to take a mean of.
    #[error("{runs} runs of {dimension} numbers have no mean; give at least one of each")]
    Empty {
        /// How many runs.
        runs: usize,
        /// Numbers of each.
        dimension: usize,
    },
    /// The band would be empty or endless.
    #[error(
        "a band cannot leave out {outside}; give each test a probability above 1e-15 and below 1"
    )]
    Outside {
        /// What was given, or each test's share of it.
        outside: f64,
    },
}
