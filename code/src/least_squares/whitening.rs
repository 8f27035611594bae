//! From a covariance to residuals in standard deviations.

use nalgebra::SMatrix;
use thiserror::Error;

// ANCHOR: sqrt_information
/// The lower triangular matrix W with Wᵀ W = Σ⁻¹. Multiplied from the left it whitens a residual
/// of covariance Σ, and its Jacobian. Implements {eq:whitening}.
///
/// # Errors
///
/// [`WhiteningError`] when the covariance is not finite, symmetric and positive definite.
pub fn sqrt_information<const D: usize>(
    covariance: &SMatrix<f64, D, D>,
) -> Result<SMatrix<f64, D, D>, WhiteningError> {
    if !covariance.iter().all(|entry| entry.is_finite()) {
        return Err(WhiteningError::NotFinite);
    }
    let asymmetry = (covariance - covariance.transpose()).amax();
    if asymmetry > 1e-9 * covariance.amax() {
        return Err(WhiteningError::NotSymmetric { asymmetry });
    }
    let factor = covariance.cholesky().ok_or(WhiteningError::NotPositiveDefinite)?;
    factor
        .l()
        .solve_lower_triangular(&SMatrix::identity())
        .ok_or(WhiteningError::NotPositiveDefinite)
}
// ANCHOR_END: sqrt_information

/// Why a matrix is not the covariance of any noise that can be whitened.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WhiteningError {
    /// An entry is NaN or infinite.
    #[error("the covariance has an entry that is not finite; give finite variances")]
    NotFinite,
    /// It differs from its transpose.
    #[error("the covariance differs from its transpose by {asymmetry}; symmetrize it")]
    NotSymmetric {
        /// The largest difference.
        asymmetry: f64,
    },
    /// Some direction has no variance, or a negative one.
    #[error(
        "the covariance is not positive definite; a measurement without noise is a constraint, so \
         remove that direction or give it a variance"
    )]
    NotPositiveDefinite,
}
