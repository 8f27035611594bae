//! Elimination in square-root form: rows are turned, and nothing is squared.

use std::array::from_fn;
use std::mem::take;

use nalgebra::{DMatrix, RealField};

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
    let columns = columns.min(rows.ncols());
    let turned = Turned::of(rows.transpose(), columns);
    let Turned { rows, own, end } = &turned;
    (rows.columns(0, *own).transpose(), rows.view_range(columns.., *own..*end).transpose())
}

/// Rows that are turned, each of them a column here, so that its numbers follow each other in memory.
pub(crate) struct Turned<T> {
    rows: DMatrix<T>,
    /// So many name the columns that are eliminated.
    own: usize,
    /// Those from here on are zero.
    end: usize,
}

impl<T: RealField + Copy> Turned<T> {
    /// Eliminates the first columns of some rows, each of them a column here.
    pub(crate) fn of(rows: DMatrix<T>, columns: usize) -> Self {
        wide(
            #[inline(always)]
            || Self::each_column(rows, columns),
        )
    }

    /// Those that name the columns that are eliminated.
    pub(crate) fn into_own(self) -> DMatrix<T> {
        let width = self.rows.nrows();
        let mut entries: Vec<T> = self.rows.data.into();
        entries.truncate(width * self.own);
        DMatrix::from_vec(width, self.own, entries)
    }

    /// The others, with zeros where those columns are.
    pub(crate) fn rest(&self) -> impl Iterator<Item = &[T]> {
        let rows = self.rows.as_slice().chunks_exact(self.rows.nrows().max(1));
        rows.take(self.end).skip(self.own)
    }

    // ANCHOR: eliminate_rows
    #[inline(always)]
    fn each_column(rows: DMatrix<T>, columns: usize) -> Self {
        let (width, height) = rows.shape();
        let lost = T::default_epsilon() * nalgebra::convert(height as f64);
        let mut turned = Self { rows, own: 0, end: height };
        let mut memory = (vec![T::zero(); height], vec![T::zero(); width]);
        for column in 0..columns {
            let lost = lost * turned.rows.row(column).norm();
            if turned.own < height && turned.rows.view_range(column, turned.own..).norm() > lost {
                turned.reflect(turned.own, column, &mut memory);
                turned.own += 1;
            } else {
                turned.rows.view_range_mut(column, turned.own..).fill(T::zero());
            }
        }
        turned.end = height.min(turned.own + width - columns);
        for (row, column) in (turned.own..turned.end).zip(columns..) {
            turned.reflect(row, column, &mut memory);
        }
        turned
    }
    // ANCHOR_END: eliminate_rows

    // ANCHOR: reflect
    /// Mirrors the rows from `own` on so that this column keeps a number in the first of them alone
    /// (Householder). The columns before it are zero there and stay so, and so do rows below the last
    /// one in which this column is not zero: they are left alone.
    #[inline(always)]
    fn reflect(&mut self, own: usize, column: usize, (axis, along): &mut (Vec<T>, Vec<T>)) {
        let below = self.rows.view_range(column, own..);
        let last = below.iter().rposition(|entry| *entry != T::zero());
        let Some(last) = last.filter(|last| *last > 0) else { return };
        axis.clear();
        axis.extend(below.iter().take(last + 1));
        let axis = axis.as_mut_slice();
        // In this unit no square is too small to be a number.
        let unit = axis.iter().fold(T::zero(), |most, entry| most.max(entry.abs()));
        divide(axis, unit);
        let length = squared(axis).sqrt().copysign(-axis[0]);
        // Of the two mirrors, the one that does not subtract.
        axis[0] -= length;
        divide(axis, squared(axis).sqrt());
        let width = self.rows.nrows();
        let turned = &mut self.rows.as_mut_slice()[own * width..][..axis.len() * width];
        let along = &mut along[column + 1..];
        along.fill(T::zero());
        let mut fours = turned.chunks_exact(4 * width);
        let (parts, last) = axis.as_chunks::<4>();
        for (four, parts) in fours.by_ref().zip(parts) {
            add_four(along, parts, from_fn(|row| &four[row * width..][column + 1..width]));
        }
        for (row, part) in fours.remainder().chunks_exact(width).zip(last) {
            add_scaled(along, *part, &row[column + 1..]);
        }
        for (row, part) in turned.chunks_exact_mut(width).zip(&*axis) {
            add_scaled(&mut row[column + 1..], -(*part + *part), along);
            row[column] = T::zero();
        }
        turned[column] = length * unit;
    }
    // ANCHOR_END: reflect
}

#[inline(always)]
fn add_scaled<T: RealField + Copy>(sums: &mut [T], by: T, numbers: &[T]) {
    sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += by * *number);
}

/// The same with four rows, so that the sums are loaded and stored once.
#[inline(always)]
fn add_four<T: RealField + Copy>(sums: &mut [T], by: &[T; 4], rows: [&[T]; 4]) {
    let [a, b, c, d] = rows.map(|row| &row[..sums.len()]);
    for (at, sum) in sums.iter_mut().enumerate() {
        *sum += (by[0] * a[at] + by[1] * b[at]) + (by[2] * c[at] + by[3] * d[at]);
    }
}

#[inline(always)]
fn divide<T: RealField + Copy>(numbers: &mut [T], by: T) {
    numbers.iter_mut().for_each(|number| *number /= by);
}

#[inline(always)]
fn squared<T: RealField + Copy>(numbers: &[T]) -> T {
    numbers.iter().fold(T::zero(), |sum, number| sum + *number * *number)
}

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
    /// As many rows as the block has directions that are seen, each of them a column here.
    pub(crate) rows: DMatrix<T>,
}

/// Eliminates blocks of the first columns, of these sizes, front by front from rows of these numbers: all
/// that name the next block are turned until only as many name it as it has columns. Those are its piece
/// of the triangle; the others join the rows and wait for the next block that they name.
///
/// Gives the pieces, and the numbers of the rows that are left: they name columns behind those of all
/// blocks.
// ANCHOR: eliminate_fronts
pub(crate) fn eliminate_fronts<T: RealField + Copy>(
    rows: &mut SparseRows<T>,
    numbers: impl IntoIterator<Item = usize>,
    sizes: &[usize],
) -> (Vec<Piece<T>>, Vec<usize>) {
    let ends = running_sums(sizes);
    let front_of =
        |first: Option<usize>| ends.partition_point(|end| *end <= first.unwrap_or(usize::MAX));
    let mut fronts = vec![Vec::new(); sizes.len() + 1];
    for number in numbers {
        fronts[front_of(rows.first_column(number))].push(number);
    }
    let mut pieces = Vec::with_capacity(sizes.len());
    for (number, end) in ends.iter().enumerate() {
        let (columns, dense) = rows.dense(&take(&mut fronts[number]));
        let named = columns.partition_point(|column| column < end);
        let turned = Turned::of(dense, named);
        let (width, height) = (columns.len() - named, turned.end - turned.own);
        rows.reserve(height, width * height);
        for (number, row) in turned.rest().enumerate() {
            let (columns, row) = (&columns[named + number..], &row[named + number..]);
            fronts[front_of(Some(columns[0]))].push(rows.len());
            rows.push(columns.iter().copied().zip(row.iter().copied()));
        }
        pieces.push(Piece { columns, rows: turned.into_own() });
    }
    (pieces, fronts.pop().unwrap_or_default())
}
// ANCHOR_END: eliminate_fronts
