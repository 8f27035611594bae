//! What measurements leave free: one count, one threshold, for every problem.
//!
//! It is made on the Jacobian and not on its square. On a street of 2,000 cameras the smallest
//! singular value that is not zero is some 1e-7 of the largest; its square is lost among the
//! rounding errors of JᵀJ.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::group::Point;
use super::orthogonal::Triangle;
use super::problem::{Buffer, Problem};
use super::singular::right_singular;
use super::solver::SolveError;
use super::spectrum::Spectrum;
use super::{Columns, Values};

// ANCHOR: rank_tolerance
/// A singular value below this fraction of the largest one is zero: rounding leaves some 1e-16.
pub const RANK_TOLERANCE: f64 = 1e-13;

/// A singular value above this fraction of the largest one is not zero. None may lie in the gap
/// between the two.
const SEEN_ABOVE: f64 = 1e-10;

/// Whether a singular value, as a fraction of the largest, is zero.
pub(super) fn check_gap(value: f64) -> Result<bool, NullSpaceError> {
    if (RANK_TOLERANCE..SEEN_ABOVE).contains(&value) {
        return Err(NullSpaceError::NoGap { value });
    }
    Ok(value < RANK_TOLERANCE)
}
// ANCHOR_END: rank_tolerance

/// Up to this many columns all singular values are computed; beyond, only the smallest.
const DENSE_COLUMNS: usize = 400;

// ANCHOR: null_space
/// The directions in which all variables can move together without any residual changing to first
/// order.
#[derive(Debug, Clone, PartialEq)]
pub struct NullSpace {
    /// Orthonormal, one a column, in coordinates in which every column of the Jacobian has length
    /// one.
    basis: DMatrix<f64>,
    /// One over the length of each column.
    scale: DVector<f64>,
    /// The smallest singular value that is not zero, as a fraction of the largest. `None` when all
    /// are zero.
    pub least_seen: Option<f64>,
}
// ANCHOR_END: null_space

impl NullSpace {
    /// A direction lies in the null space when no more than this part of it lies outside.
    pub const TOLERANCE: f64 = 1e-4;

    pub(super) fn new(basis: DMatrix<f64>, scale: DVector<f64>, least_seen: Option<f64>) -> Self {
        Self { basis, scale, least_seen }
    }

    /// How many independent directions are free.
    pub fn nullity(&self) -> usize {
        self.basis.ncols()
    }

    /// The free directions, one a column, with a row for each column of the Jacobian. They have no
    /// particular length.
    pub fn directions(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.basis.nrows(), self.basis.ncols(), |row, column| {
            self.scale[row] * self.basis[(row, column)]
        })
    }

    /// How many of the free directions move nothing but these columns.
    pub fn within(&self, columns: Range<usize>) -> usize {
        let (sines, _) = right_singular(self.basis.rows_range(columns).transpose());
        sines.iter().filter(|sine| 1.0 - sine.powi(2) < Self::TOLERANCE.powi(2)).count()
    }

    /// The error that says that something is free, or `None` when nothing is.
    pub fn singular(&self) -> Option<SingularSystem> {
        let (dimension, free) = self.basis.shape();
        (free > 0).then(|| SingularSystem { free, dimension, basis: self.directions().qr().q() })
    }

    /// Why a step is not determined by the normal equations.
    pub(crate) fn undetermined(&self) -> SolveError {
        self.singular().map_or_else(|| self.lost_to_rounding(), SolveError::Singular)
    }

    /// The error of what is seen, and not kept by the normal equations.
    pub(crate) fn lost_to_rounding(&self) -> SolveError {
        SolveError::LostToRounding { least_seen: self.least_seen.unwrap_or(0.0) }
    }

    // ANCHOR: leaves
    /// How much of a direction, as a part of its length in scaled coordinates, lies outside of the
    /// null space: 0 when it is free, 1 when nothing of it is.
    pub fn leaves(&self, direction: &DVector<f64>) -> f64 {
        let (length, unit) = self.scaled(direction);
        let outside = &unit - &self.basis * self.basis.tr_mul(&unit);
        if length > 0.0 { outside.norm() } else { 1.0 }
    }

    /// The length of a direction in scaled coordinates, and the direction at length one there.
    pub fn scaled(&self, direction: &DVector<f64>) -> (f64, DVector<f64>) {
        let scaled = direction.component_div(&self.scale);
        let length = scaled.norm();
        (length, if length > 0.0 { scaled / length } else { scaled })
    }
    // ANCHOR_END: leaves

    // ANCHOR: combinations
    /// The sums of these directions that are free, by the factor of each direction, one sum a
    /// column. The directions have to be independent.
    pub fn combinations(&self, directions: &[DVector<f64>]) -> DMatrix<f64> {
        if directions.is_empty() {
            return DMatrix::zeros(0, 0);
        }
        let (lengths, units): (Vec<f64>, Vec<_>) =
            directions.iter().map(|direction| self.scaled(direction)).unzip();
        let units = DMatrix::from_columns(&units);
        let outside = &units - &self.basis * self.basis.tr_mul(&units);
        let sums = Self::sums_that_vanish(&outside, &units);
        let free = sums.ncols().min(self.nullity());
        DMatrix::from_fn(sums.nrows(), free, |row, column| sums[(row, column)] / lengths[row])
    }

    /// The factors of all sums of columns that vanish, beside the size of the columns that they
    /// were made of.
    pub(crate) fn sums_that_vanish(columns: &DMatrix<f64>, whole: &DMatrix<f64>) -> DMatrix<f64> {
        let size = whole.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
        let (values, factors) = right_singular(columns.clone());
        let vanish = values.iter().take_while(|value| **value < Self::TOLERANCE * size).count();
        factors.columns(0, vanish).into_owned()
    }
    // ANCHOR_END: combinations
}

impl Problem {
    /// What the factors leave free at `values`.
    ///
    /// # Errors
    ///
    /// [`NullSpaceError::NoGap`] when that cannot be said, those of [`Problem::jacobian`], and
    /// [`SolveError::OutOfRange`]. Of a problem without factors everything is free.
    pub fn null_space(&self, values: &Values) -> Result<NullSpace, SolveError> {
        self.check_values(values)?;
        self.at(values, |at| self.null_space_at(at))
    }

    /// Whether nothing is free at a point; not when it cannot be said.
    pub(crate) fn is_determined(&self, at: Point) -> bool {
        self.null_space_at(at).is_ok_and(|null_space| null_space.nullity() == 0)
    }

    pub(super) fn null_space_at(&self, at: Point) -> Result<NullSpace, SolveError> {
        let columns = self.columns();
        if columns.count > DENSE_COLUMNS {
            return Triangle::of(self, at, &columns)?.null_space();
        }
        let (jacobian, _) = self.jacobian_at(at, &columns)?;
        Ok(Spectrum::of(&jacobian)?.null_space())
    }

    // ANCHOR: jacobian
    /// The whitened Jacobian and the residual at `values`, all in one, times the root of each factor's
    /// kernel weight: a row for each number of each factor, in the order of the factors' types, a column for each of [`Problem::columns`].
    ///
    /// # Errors
    ///
    /// [`SolveError::WrongValues`], [`SolveError::Undefined`] and [`SolveError::NotFinite`].
    pub fn jacobian(&self, values: &Values) -> Result<(DMatrix<f64>, DVector<f64>), SolveError> {
        self.check_values(values)?;
        self.at(values, |at| self.jacobian_at(at, &self.columns()))
    }

    /// The same with a column for each coordinate, zero for what is held, whatever is tied.
    pub(crate) fn jacobian_by_coordinates(
        &self,
        values: &Values,
    ) -> Result<(DMatrix<f64>, DVector<f64>), SolveError> {
        self.check_values(values)?;
        self.at(values, |at| self.jacobian_at(at, &self.coordinate_columns()))
    }

    pub(super) fn jacobian_at(
        &self,
        at: Point,
        columns: &Columns,
    ) -> Result<(DMatrix<f64>, DVector<f64>), SolveError> {
        let mut jacobian = DMatrix::zeros(self.rows(), columns.count);
        let mut residual = DVector::zeros(self.rows());
        let mut number = 0;
        self.each_row(at, columns, &mut Buffer::default(), |row| {
            residual[number] = row.residual;
            for (column, slope) in row.entries {
                jacobian[(number, *column)] = *slope;
            }
            number += 1;
        })?;
        Ok((jacobian, residual))
    }
    // ANCHOR_END: jacobian
}

/// The measurements leave directions in which everything can move and no residual changes.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "the system leaves {free} of {dimension} directions free; hold variables or add measurements"
)]
pub struct SingularSystem {
    /// The number of free directions.
    pub free: usize,
    /// The number of all directions.
    pub dimension: usize,
    /// An orthonormal basis of the free directions, one a column, with a row for each of
    /// [`Problem::columns`].
    pub basis: DMatrix<f64>,
}

/// Why nothing can be said about what is free.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NullSpaceError {
    /// A derivative is not finite.
    #[error("row {row} of the Jacobian is not finite; look for a NaN")]
    NotFinite {
        /// The row.
        row: usize,
    },
    /// A singular value is neither zero nor surely different from it.
    #[error(
        "a singular value is {value:.1e} of the largest, too much for rounding and too little to \
         be sure; the geometry is degenerate but for almost nothing, or the estimate is not exact"
    )]
    NoGap {
        /// The value, as a fraction of the largest.
        value: f64,
    },
}
