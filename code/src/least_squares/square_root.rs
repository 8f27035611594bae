//! Elimination in square-root form: rows are turned, and nothing is squared.

use std::mem::take;

use nalgebra::{DMatrix, RealField};

use super::mirrors::{LANES, Mirrors, Rows};
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
    let (width, columns) = (rows.ncols(), columns.min(rows.ncols()));
    let Turned { rows, own, end } = Turned::of(Rows::of(&rows), columns);
    (rows.part(0..own, 0..width), rows.part(own..end, columns..width))
}

/// Rows that have been turned.
pub(crate) struct Turned<T> {
    pub(crate) rows: Rows<T>,
    /// So many name the columns that are eliminated.
    pub(crate) own: usize,
    /// Those from here on are zero.
    end: usize,
}

impl<T: RealField + Copy> Turned<T> {
    /// Eliminates the first columns of some rows.
    pub(crate) fn of(rows: Rows<T>, columns: usize) -> Self {
        wide(
            #[inline(always)]
            || Self::each_column(rows, columns),
        )
    }

    /// Lane by lane. Behind the columns that are eliminated every column has a row, until there is none.
    #[inline(always)]
    fn each_column(mut rows: Rows<T>, columns: usize) -> Self {
        let (height, width) = rows.shape();
        let lost = T::default_epsilon() * nalgebra::convert(height as f64);
        let (mut own, mut row) = (0, 0);
        let mut mirrors = Mirrors::new();
        for first in (0..width).step_by(LANES) {
            let (lane, behind) = rows.lane(first);
            mirrors.clear();
            for column in first..width.min(first + LANES) {
                if row == height {
                    break;
                }
                if column < columns {
                    own += usize::from(mirrors.add(lane, row, column - first, lost));
                    row = own;
                } else {
                    mirrors.add(lane, row, column - first, T::zero());
                    row += 1;
                }
            }
            for lane in behind {
                mirrors.turn(lane);
            }
        }
        Self { rows, own, end: height.min(own + width - columns) }
    }
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
    /// As many of the rows as the block has directions that are seen.
    pub(crate) rows: Rows<T>,
    pub(crate) own: usize,
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
        let Turned { rows: dense, own, end } = Turned::of(dense, named);
        rows.reserve(end - own, (columns.len() - named) * (end - own));
        for number in own..end {
            let first = named + number - own;
            fronts[front_of(Some(columns[first]))].push(rows.len());
            rows.push((first..columns.len()).map(|at| (columns[at], dense.at(number, at))));
        }
        pieces.push(Piece { columns, rows: dense, own });
    }
    (pieces, fronts.pop().unwrap_or_default())
}
// ANCHOR_END: eliminate_fronts
