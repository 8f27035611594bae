//! A Cholesky factorization that says where it fails.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, RealField};

use super::{Blocks, MarginalizationError};

/// The number in double precision.
pub(super) fn double<T: RealField + Copy>(number: T) -> f64 {
    nalgebra::try_convert(number).unwrap_or(f64::NAN)
}

/// The number in another precision.
pub(super) fn cast<T: RealField + Copy, U: RealField>(number: T) -> U {
    nalgebra::convert(double(number))
}

/// A pivot below this fraction of the diagonal is lost in rounding.
fn lost<T: RealField + Copy>(dimension: usize) -> f64 {
    4.0 * double(T::default_epsilon()) * dimension as f64
}

/// A pivot as a fraction of the block's own information.
fn share<T: RealField + Copy>(pivot: T, own: T) -> f64 {
    if own == T::zero() { double(pivot) } else { double(pivot / own.abs()) }
}

/// What a pivot that is not positive says.
fn verdict<T: RealField + Copy>(name: usize, pivot: f64) -> MarginalizationError {
    // A pivot that should be zero is off by the rounding of all that was subtracted.
    match pivot < -double(T::default_epsilon()).sqrt() {
        true => MarginalizationError::Indefinite { name, pivot },
        false => MarginalizationError::Singular { name, pivot },
    }
}

// ANCHOR: factorize
/// The Cholesky factor of the information of some blocks, none of whose pivots is lost beside the
/// block's own information, `diagonal`.
pub(super) fn factorize<T: RealField + Copy>(
    matrix: DMatrix<T>,
    diagonal: &DVector<T>,
    name_at: impl Fn(usize) -> usize,
) -> Result<Cholesky<T, Dyn>, MarginalizationError> {
    let lost = lost::<T>(diagonal.len());
    let Some(factor) = Cholesky::new(matrix.clone()) else {
        let (column, pivot) = failing_pivot(matrix);
        return Err(verdict::<T>(name_at(column), share(pivot, diagonal[column])));
    };
    for (column, own) in diagonal.iter().enumerate() {
        let root = factor.l_dirty()[(column, column)];
        let pivot = share(root * root, *own);
        if pivot <= lost {
            return Err(verdict::<T>(name_at(column), pivot));
        }
    }
    Ok(factor)
}
// ANCHOR_END: factorize

/// The first pivot of a symmetric matrix that is not positive, and its column.
fn failing_pivot<T: RealField + Copy>(mut matrix: DMatrix<T>) -> (usize, T) {
    for column in 0..matrix.nrows() {
        let pivot = matrix[(column, column)];
        if pivot <= T::zero() || !pivot.is_finite() {
            return (column, pivot);
        }
        let below = matrix.view_range(column + 1.., column).into_owned();
        let mut rest = matrix.view_range_mut(column + 1.., column + 1..);
        rest.ger(-pivot.recip(), &below, &below, T::one());
    }
    (0, T::zero())
}

/// The Cholesky factor of the information of all blocks.
pub(super) fn factorize_blocks<T: RealField + Copy>(
    matrix: &DMatrix<T>,
    blocks: &Blocks,
) -> Result<Cholesky<T, Dyn>, MarginalizationError> {
    factorize(matrix.clone(), &matrix.diagonal(), |column| blocks.name_at(column))
}
