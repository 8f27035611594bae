//! Elimination in square-root form: rows are turned, and nothing is squared.

use std::mem::take;

use nalgebra::{DMatrix, DVector, RealField};

use super::sparse_rows::SparseRows;
use crate::registers::wide;

/// Eliminates the first columns of some rows, the last column of which may be the residual: turns the
/// rows by an orthogonal matrix until no more of them name these columns than there are of them.
///
/// Gives these rows, as many as the columns have independent directions, and then those that say
/// everything else that was said, without the first columns. A direction of a column that is seen by
/// no more than rounding, beside the rows before it, has no row.
pub fn eliminate<T: RealField + Copy>(
    rows: DMatrix<T>,
    columns: usize,
) -> (DMatrix<T>, DMatrix<T>) {
    wide(
        #[inline(always)]
        || turned(rows, columns),
    )
}

// ANCHOR: eliminate_rows
#[inline(always)]
fn turned<T: RealField + Copy>(mut rows: DMatrix<T>, columns: usize) -> (DMatrix<T>, DMatrix<T>) {
    let columns = columns.min(rows.ncols());
    let lost = T::default_epsilon() * nalgebra::convert(rows.nrows() as f64);
    let mut axis = DVector::zeros(rows.nrows());
    let mut own = 0;
    for column in 0..columns {
        let lost = lost * rows.column(column).norm();
        if own < rows.nrows() && rows.view_range(own.., column).norm() > lost {
            reflect(&mut rows, own, column, &mut axis);
            own += 1;
        } else {
            rows.view_range_mut(own.., column).fill(T::zero());
        }
    }
    let end = rows.nrows().min(own + rows.ncols() - columns);
    for (row, column) in (own..end).zip(columns..) {
        reflect(&mut rows, row, column, &mut axis);
    }
    (rows.rows(0, own).into_owned(), rows.view_range(own..end, columns..).into_owned())
}
// ANCHOR_END: eliminate_rows

// ANCHOR: reflect
/// Mirrors the rows from `own` on so that this column keeps a number in the first of them alone
/// (Householder). The columns before it are zero there and stay so, and so do rows below the last
/// one in which this column is not zero: they are left alone.
#[inline(always)]
fn reflect<T: RealField + Copy>(
    rows: &mut DMatrix<T>,
    own: usize,
    column: usize,
    memory: &mut DVector<T>,
) {
    let below = rows.view_range(own.., column);
    let last = below.iter().rposition(|entry| *entry != T::zero());
    let Some(last) = last.filter(|last| *last > 0) else { return };
    let turned = own..=own + last;
    let mut axis = memory.rows_range_mut(turned.clone());
    axis.copy_from(&rows.view_range(turned.clone(), column));
    // In this unit no square is too small to be a number.
    let unit = axis.amax();
    axis.unscale_mut(unit);
    let length = axis.norm().copysign(-axis[0]);
    // Of the two mirrors, the one that does not subtract.
    axis[0] -= length;
    axis.normalize_mut();
    for later in column + 1..rows.ncols() {
        let mut turned = rows.view_range_mut(turned.clone(), later);
        let along = axis.dot(&turned);
        turned.axpy(-(along + along), &axis, T::one());
    }
    rows.view_range_mut(turned, column).fill(T::zero());
    rows[(own, column)] = length * unit;
}
// ANCHOR_END: reflect

/// For each number its sum with all before it.
fn running_sums(numbers: &[usize]) -> Vec<usize> {
    let mut sum = 0;
    let add = |number: &usize| {
        sum += number;
        sum
    };
    numbers.iter().map(add).collect()
}

/// The rows of a triangle that belong to one block of columns.
pub(crate) struct Piece<T> {
    /// The columns of the block that rows name, then later ones.
    pub(crate) columns: Vec<usize>,
    /// As many rows as the block has directions that are seen.
    pub(crate) rows: DMatrix<T>,
}

/// Eliminates blocks of the first columns, of these sizes, front by front: all rows that name the next
/// block are turned until only as many name it as it has columns. Those are its piece of the
/// triangle; the others wait for the next block that they name.
///
/// Gives the pieces, and the rows that are left: they name columns behind those of all blocks.
// ANCHOR: eliminate_fronts
pub(crate) fn eliminate_fronts<'a, T: RealField + Copy>(
    rows: impl IntoIterator<Item = &'a [(usize, T)]>,
    sizes: &[usize],
) -> (Vec<Piece<T>>, SparseRows<T>) {
    let ends = running_sums(sizes);
    let front_of = |first: usize| ends.partition_point(|end| *end <= first);
    let mut fronts: Vec<SparseRows<T>> = vec![SparseRows::default(); sizes.len() + 1];
    for row in rows {
        let first = row.iter().map(|(column, _)| *column).min().unwrap_or(usize::MAX);
        fronts[front_of(first)].push(row.iter().copied());
    }
    let mut pieces = Vec::with_capacity(sizes.len());
    for (number, end) in ends.iter().enumerate() {
        let (columns, dense) = take(&mut fronts[number]).dense();
        let named = columns.partition_point(|column| column < end);
        let (rows, rest) = eliminate(dense, named);
        for (number, row) in rest.row_iter().enumerate() {
            let entries = columns[named..].iter().copied().zip(row.iter().copied());
            fronts[front_of(columns[named + number])].push(entries.skip(number));
        }
        pieces.push(Piece { columns, rows });
    }
    (pieces, fronts.pop().unwrap_or_default())
}
// ANCHOR_END: eliminate_fronts
