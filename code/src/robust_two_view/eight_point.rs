//! The essential matrix from eight points or more.

use nalgebra::{DMatrix, Matrix3};
use thiserror::Error;

use super::linear::{least_vector, normalization};
use super::{RayPair, matches_are_finite};

// ANCHOR: eight_points
/// The matrix that makes the volumes {eq:coplanarity} of eight pairs of rays or more smallest, in
/// coordinates with mean zero and a mean square of two [@hartley1997eight]: the nearest essential one
/// is what [`relative_poses`](crate::two_views::relative_poses) takes.
///
/// The rays point forward. What is least here is no distance in a picture, so the matrix is a start.
///
/// # Errors
///
/// [`EightPointError`], among others for points in one plane, of which infinitely many matrices
/// are one.
pub fn eight_points(pairs: &[RayPair]) -> Result<Matrix3<f64>, EightPointError> {
    if pairs.len() < 8 {
        return Err(EightPointError::TooFew { count: pairs.len() });
    }
    matches_are_finite(pairs).map_err(|pair| EightPointError::Ray { pair })?;
    let first =
        normalization(pairs.iter().map(|pair| &pair.0)).ok_or(EightPointError::Degenerate)?;
    let second =
        normalization(pairs.iter().map(|pair| &pair.1)).ok_or(EightPointError::Degenerate)?;
    // Fewer rows than columns would leave a null vector for nothing.
    let mut rows = DMatrix::zeros(pairs.len().max(9), 9);
    for (mut row, (a, b)) in rows.row_iter_mut().zip(pairs) {
        let (a, b) = (first * a / a.z, second * b / b.z);
        row.copy_from_slice((a * b.transpose()).as_slice());
    }
    let entries = least_vector(rows).ok_or(EightPointError::Degenerate)?;
    let normalized = Matrix3::from_row_slice(entries.as_slice());
    Ok((second.transpose() * normalized * first).normalize())
}
// ANCHOR_END: eight_points

/// Why there is no matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum EightPointError {
    /// There are fewer than eight.
    #[error("there are {count} points; give eight or more")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// A ray is not finite or does not point forward.
    #[error("pair {pair}: a ray is not finite or does not point forward; leave the pair out")]
    Ray {
        /// Which pair.
        pair: usize,
    },
    /// More than one matrix fits.
    #[error(
        "more than one matrix fits: the points lie in one plane or on a critical surface, or the \
         camera only turned; use the five-point method or a homography"
    )]
    Degenerate,
}
