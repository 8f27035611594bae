//! The chi-square distribution, which squares of normalized errors follow.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use thiserror::Error;

// ANCHOR: below
/// The probability that the sum of the squares of `degrees` independent numbers, each with mean
/// zero and variance one and normal, is below `x`. A sum of none is zero. NaN in gives NaN out.
pub fn chi_square_below(x: f64, degrees: usize) -> f64 {
    match ChiSquared::new(degrees as f64) {
        Ok(distribution) => distribution.cdf(x),
        Err(_) if x.is_nan() => x,
        Err(_) => f64::from(x >= 0.0),
    }
}
// ANCHOR_END: below

/// The probability that the same sum is above `x`, with all digits where it is small.
pub fn chi_square_above(x: f64, degrees: usize) -> f64 {
    match ChiSquared::new(degrees as f64) {
        Ok(distribution) => distribution.sf(x),
        Err(_) if x.is_nan() => x,
        Err(_) => f64::from(x < 0.0),
    }
}

// ANCHOR: quantile
/// What the same sum stays below with this probability: the inverse of [`chi_square_below`], to 1e-9
/// of itself or of one, whichever is larger, up to a probability of one less 1e-6: nearer to one, numbers do not
/// tell probabilities apart well enough.
///
/// # Errors
///
/// [`ChiSquareError`] when `probability` is not between zero and one.
pub fn chi_square_quantile(probability: f64, degrees: usize) -> Result<f64, ChiSquareError> {
    if !(0.0..=1.0).contains(&probability) {
        return Err(ChiSquareError { probability });
    }
    let distribution = ChiSquared::new(degrees as f64);
    Ok(distribution.map_or(0.0, |distribution| distribution.inverse_cdf(probability)))
}
// ANCHOR_END: quantile

// ANCHOR: ends
/// The two ends between which the same sum lies, except with the probability `outside`, half of it
/// below and half above.
///
/// # Errors
///
/// [`ChiSquareError`] when `outside` is not between zero and one.
pub fn chi_square_band(outside: f64, degrees: usize) -> Result<[f64; 2], ChiSquareError> {
    if !(0.0..=1.0).contains(&outside) {
        return Err(ChiSquareError { probability: outside });
    }
    let end = |probability| chi_square_quantile(probability, degrees);
    Ok([end(0.5 * outside)?, end(1.0 - 0.5 * outside)?])
}
// ANCHOR_END: ends

/// A number that is no probability.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{probability} is not a probability; give a number from 0 to 1")]
pub struct ChiSquareError {
    /// What was given.
    pub probability: f64,
}
