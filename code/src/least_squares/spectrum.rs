//! Singular values of a Jacobian: what its rows determine, and how well.

use nalgebra::{DMatrix, DVector};

use super::null_space::{NullSpace, NullSpaceError, check_gap};
use super::singular::right_singular;

// ANCHOR: spectrum_type
/// The singular values of a whitened Jacobian whose columns have been scaled to length one, so
/// that radians, metres and metres per second can be compared: {eq:scaled-jacobian}.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// As fractions of the largest, ascending.
    pub singular_values: Vec<f64>,
    /// How many of them are zero.
    pub zeros: usize,
    /// Right singular vectors in scaled coordinates, one a column, in the same order.
    vectors: DMatrix<f64>,
    /// One over the length of each column.
    scale: DVector<f64>,
    largest: f64,
}
// ANCHOR_END: spectrum_type

impl Spectrum {
    // ANCHOR: spectrum
    /// The spectrum of a Jacobian with any number of rows.
    ///
    /// # Errors
    ///
    /// [`NullSpaceError::NotFinite`], and [`NullSpaceError::NoGap`] when it cannot be said which
    /// values are zero.
    pub fn of(jacobian: &DMatrix<f64>) -> Result<Self, NullSpaceError> {
        if let Some(row) = jacobian.row_iter().position(|row| !row.iter().all(|x| x.is_finite())) {
            return Err(NullSpaceError::NotFinite { row });
        }
        // In units of the largest entry no square is too large.
        let length = |most: f64, column: DVector<f64>| {
            if most > 0.0 { most * (column / most).norm() } else { 0.0 }
        };
        let lengths = jacobian.column_iter().map(|c| scale_of(length(c.amax(), c.into_owned())));
        let scale = DVector::from_iterator(jacobian.ncols(), lengths);
        let (values, vectors) = right_singular(jacobian * DMatrix::from_diagonal(&scale));
        let largest = values.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        let singular_values: Vec<f64> = values.iter().map(|value| value / largest).collect();
        let mut zeros = 0;
        for value in &singular_values {
            zeros += usize::from(check_gap(*value)?);
        }
        Ok(Self { singular_values, zeros, vectors, scale, largest })
    }
    // ANCHOR_END: spectrum

    /// What the rows leave free.
    pub fn null_space(&self) -> NullSpace {
        let basis = self.vectors.columns(0, self.zeros).into_owned();
        let least_seen = self.singular_values.get(self.zeros).copied();
        NullSpace::new(basis, self.scale.clone(), least_seen)
    }

    // ANCHOR: sigma
    /// The standard deviation of a quantity with this gradient over all columns, or `None` when it
    /// changes along a free direction: then no measurement bounds it.
    ///
    /// Implements {eq:quantity-sigma}.
    pub fn sigma(&self, gradient: &DVector<f64>) -> Option<f64> {
        let scaled = gradient.component_mul(&self.scale);
        let along = self.vectors.tr_mul(&scaled);
        let free = along.rows(0, self.zeros).norm();
        let variance: f64 = (self.zeros..along.len())
            .map(|i| (along[i] / (self.largest * self.singular_values[i])).powi(2))
            .sum();
        (free <= NullSpace::TOLERANCE * scaled.norm()).then(|| variance.sqrt())
    }
    // ANCHOR_END: sigma

    // ANCHOR: covariance
    /// The inverse of JᵀJ, or `None` when some direction is free. Implements
    /// {eq:estimate-covariance}.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        // V Σ⁻² Vᵀ, of which the unscaled rows of V Σ⁻¹ make one square.
        let size = self.scale.len();
        let root = DMatrix::from_fn(size, size, |row, column| {
            let value = self.largest * self.singular_values[column];
            self.scale[row] * self.vectors[(row, column)] / value
        });
        (self.zeros == 0).then(|| &root * root.transpose())
    }
    // ANCHOR_END: covariance
}

/// What scales a column of this length to length one.
pub(super) fn scale_of(length: f64) -> f64 {
    if length > 0.0 { length.recip() } else { 1.0 }
}
