//! Rows of numbers, and the mirrors that turn them (Householder).

use std::array::from_fn;
use std::ops::Range;

use nalgebra::{DMatrix, RealField};

/// So many columns are turned at once.
pub const LANES: usize = 8;

/// What a row has in so many columns.
pub type Lane<T> = [T; LANES];

/// Rows of numbers, kept by lanes: the first one of all rows, then the next one of all rows. A lane of many
/// rows stays in the fastest memory while they are turned.
pub struct Rows<T> {
    lanes: Vec<Lane<T>>,
    height: usize,
    width: usize,
}

impl<T: RealField + Copy> Rows<T> {
    pub fn zeros(height: usize, width: usize) -> Self {
        let lanes = vec![[T::zero(); LANES]; height * width.div_ceil(LANES)];
        Self { lanes, height, width }
    }

    pub fn of(matrix: &DMatrix<T>) -> Self {
        let mut rows = Self::zeros(matrix.nrows(), matrix.ncols());
        for (column, entries) in matrix.column_iter().enumerate() {
            entries.iter().enumerate().for_each(|(row, entry)| rows.put(row, column, *entry));
        }
        rows
    }

    /// How many rows and columns there are.
    pub fn shape(&self) -> (usize, usize) {
        (self.height, self.width)
    }

    #[inline(always)]
    pub fn at(&self, row: usize, column: usize) -> T {
        self.lanes[column / LANES * self.height + row][column % LANES]
    }

    #[inline(always)]
    pub fn put(&mut self, row: usize, column: usize, entry: T) {
        self.lanes[column / LANES * self.height + row][column % LANES] = entry;
    }

    /// The part of these rows and columns.
    pub fn part(&self, rows: Range<usize>, columns: Range<usize>) -> DMatrix<T> {
        DMatrix::from_fn(rows.len(), columns.len(), |row, column| {
            self.at(rows.start + row, columns.start + column)
        })
    }

    /// The lane of all rows that begins with this column, and the lanes behind it.
    #[inline(always)]
    pub fn lane(
        &mut self,
        column: usize,
    ) -> (&mut [Lane<T>], impl Iterator<Item = &mut [Lane<T>]>) {
        let (lane, behind) = self.lanes[column / LANES * self.height..].split_at_mut(self.height);
        (lane, behind.chunks_exact_mut(self.height.max(1)))
    }
}

/// Mirrors that one lane's columns made, to be held against the lanes behind it.
pub struct Mirrors<T> {
    all: Vec<Mirror<T>>,
    /// Their axes, one behind the other.
    axes: Vec<T>,
}

/// A mirror I + f v vᵀ of rows that follow each other.
struct Mirror<T> {
    rows: Range<usize>,
    /// Where its axis v is.
    axis: Range<usize>,
    factor: T,
}

impl<T: RealField + Copy> Mirrors<T> {
    pub fn new() -> Self {
        Self { all: Vec::new(), axes: Vec::new() }
    }

    pub fn clear(&mut self) {
        self.all.clear();
        self.axes.clear();
    }

    /// Mirrors the rows from `first` on so that this column of a lane keeps a number in the first of them
    /// alone, down to the last one that has another there. False, and zeros, when no more is left of the
    /// column than this part of what all rows have.
    #[inline(always)]
    pub fn add(&mut self, lane: &mut [Lane<T>], first: usize, column: usize, lost: T) -> bool {
        let last = lane[first..].iter().rposition(|row| row[column] != T::zero());
        let rows = first..last.map_or(first, |last| first + last + 1);
        let start = self.axes.len();
        self.axes.extend(lane[rows.clone()].iter().map(|row| row[column]));
        let axis = &mut self.axes[start..];
        // In this unit no square is too small to be a number.
        let unit = axis.iter().fold(T::zero(), |most, entry| most.max(entry.abs()));
        axis.iter_mut().for_each(|entry| *entry /= unit);
        let length = squares(axis).sqrt();
        let above = lane[..first].iter().fold(T::zero(), |sum, row| sum + row[column].powi(2));
        if length * unit <= lost * (length * unit).hypot(above.sqrt()) {
            lane[first..].iter_mut().for_each(|row| row[column] = T::zero());
            self.axes.truncate(start);
            return false;
        }
        if rows.len() > 1 {
            // Of the two mirrors, the one that does not subtract.
            let length = length.copysign(-axis[0]);
            axis[0] -= length;
            let factor = (axis[0] * length).recip();
            let lane = &mut lane[rows.clone()];
            turn(lane, axis, factor);
            lane.iter_mut().for_each(|row| row[column] = T::zero());
            lane[0][column] = length * unit;
            self.all.push(Mirror { rows, axis: start..self.axes.len(), factor });
        }
        true
    }

    /// Holds them against another lane, one after the other.
    #[inline(always)]
    pub fn turn(&self, lane: &mut [Lane<T>]) {
        for Mirror { rows, axis, factor } in &self.all {
            turn(&mut lane[rows.clone()], &self.axes[axis.clone()], *factor);
        }
    }
}

/// Adds f v vᵀ times the rows to them, two rows at a time: sums of one alone would wait for each other.
#[inline(always)]
fn turn<T: RealField + Copy>(rows: &mut [Lane<T>], axis: &[T], factor: T) {
    let (pairs, last) = rows.as_chunks_mut::<2>();
    let (pairs_of_axis, last_of_axis) = axis.as_chunks::<2>();
    let mut sums = [[T::zero(); LANES]; 2];
    for (pair, axis) in pairs.iter().zip(pairs_of_axis) {
        sums = from_fn(|row| add(&sums[row], axis[row], &pair[row]));
    }
    for (row, axis) in last.iter().zip(last_of_axis) {
        sums[0] = add(&sums[0], *axis, row);
    }
    let sum: Lane<T> = from_fn(|at| factor * (sums[0][at] + sums[1][at]));
    for (pair, axis) in pairs.iter_mut().zip(pairs_of_axis) {
        *pair = from_fn(|row| add(&pair[row], axis[row], &sum));
    }
    for (row, axis) in last.iter_mut().zip(last_of_axis) {
        *row = add(row, *axis, &sum);
    }
}

#[inline(always)]
fn add<T: RealField + Copy>(to: &Lane<T>, by: T, numbers: &Lane<T>) -> Lane<T> {
    from_fn(|at| to[at] + by * numbers[at])
}

/// The sum of squares, by lanes.
#[inline(always)]
fn squares<T: RealField + Copy>(numbers: &[T]) -> T {
    let (lanes, last) = numbers.as_chunks::<LANES>();
    let mut sums = [T::zero(); LANES];
    for lane in lanes {
        sums = from_fn(|at| sums[at] + lane[at] * lane[at]);
    }
    let squares = sums.into_iter().chain(last.iter().map(|number| *number * *number));
    squares.fold(T::zero(), |sum, square| sum + square)
}
