//! Which directions an approximation claims to know better than they are known.

use nalgebra::{DMatrix, DVector, RealField};

use super::pivots::factorize_blocks;
use super::{Information, MarginalizationError, marginalize};

// ANCHOR: over_confidence
/// True over reported variances, in the directions in which they are stationary: the generalized
/// eigenvalues of the reported information matrix and the true one. They do not depend on units.
#[derive(Debug, Clone, PartialEq)]
pub struct OverConfidence<T: RealField> {
    /// Ascending. Above one the reported variance is too small: over-confident; below one it is too
    /// large.
    pub ratios: DVector<T>,
    /// For each of them the quantity, as its gradient over the coordinates of all blocks, whose
    /// variances have this ratio; one a column. With respect to the true covariance they have variance
    /// one and do not vary together.
    pub quantities: DMatrix<T>,
}
// ANCHOR_END: over_confidence

impl<T: RealField + Copy> OverConfidence<T> {
    /// Compares what is reported with the truth.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::DifferentBlocks`], and [`MarginalizationError::Singular`] or
    /// [`MarginalizationError::Indefinite`] when the truth leaves a direction free. What is reported
    /// may be anything: a ratio that is not positive belongs to a quantity without a variance.
    // ANCHOR: over_confidence_of
    pub fn of(
        truth: &Information<T>,
        reported: &Information<T>,
    ) -> Result<Self, MarginalizationError> {
        if truth.blocks() != reported.blocks() {
            return Err(MarginalizationError::DifferentBlocks);
        }
        let factor = factorize_blocks(truth.matrix(), truth.blocks())?.unpack();
        // L⁻¹ Λ L⁻ᵀ, with both sides in turn.
        let mut scaled = reported.matrix().clone();
        factor.solve_lower_triangular_unchecked_mut(&mut scaled);
        scaled.transpose_mut();
        factor.solve_lower_triangular_unchecked_mut(&mut scaled);
        let eigen = scaled.symmetric_eigen();
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|a, b| {
            let (a, b) = (eigen.eigenvalues[*a], eigen.eigenvalues[*b]);
            a.partial_cmp(&b).unwrap_or(std::cmp::Ordering::Equal)
        });
        let quantities = factor * eigen.eigenvectors.select_columns(&order);
        Ok(Self { ratios: eigen.eigenvalues.select_rows(&order), quantities })
    }
    // ANCHOR_END: over_confidence_of

    /// Compares what is reported of one block, whatever the others are.
    ///
    /// # Errors
    ///
    /// As those of [`OverConfidence::of`], also for what is reported, and
    /// [`MarginalizationError::Unknown`].
    pub fn of_block(
        truth: &Information<T>,
        reported: &Information<T>,
        name: usize,
    ) -> Result<Self, MarginalizationError> {
        truth.blocks().columns_of(name)?;
        let others: Vec<usize> = truth.blocks().names().filter(|other| *other != name).collect();
        if others.is_empty() {
            return Self::of(truth, reported);
        }
        Self::of(&marginalize(truth, &others)?, &marginalize(reported, &others)?)
    }

    /// The largest ratio: how far the variance of some quantity is claimed too small. Not above one, to
    /// rounding, when the report is *conservative*.
    pub fn largest(&self) -> T {
        self.ratios.max()
    }

    /// The smallest ratio: how far the variance of some quantity is claimed too large.
    pub fn smallest(&self) -> T {
        self.ratios.min()
    }

    // ANCHOR: inflate
    /// What is reported, with the same mean and all its variances multiplied by the largest ratio, if
    /// that is above one: the least multiple that is conservative in every direction.
    pub fn inflate(&self, reported: &Information<T>) -> Information<T> {
        let factor = self.largest().max(T::one()).recip();
        let (matrix, vector) = (reported.matrix() * factor, reported.vector() * factor);
        Information::of_parts(reported.blocks().clone(), matrix, vector)
    }
    // ANCHOR_END: inflate
}
