//! Rows of a linear system that are turned against each other.

use nalgebra::{DMatrix, DVector};

// ANCHOR: rows
/// Rows of numbers, one behind the other in memory, so that turning two of them is fast.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    width: usize,
    numbers: Vec<f64>,
}
// ANCHOR_END: rows

impl Rows {
    /// No rows of so many numbers.
    pub fn new(width: usize) -> Self {
        Self { width, numbers: Vec::new() }
    }

    /// Forgets all rows. Later ones have another number of columns; the memory stays.
    pub fn clear(&mut self, width: usize) {
        self.width = width;
        self.numbers.clear();
    }

    /// Adds a row of zeros and gives it.
    pub fn add(&mut self) -> &mut [f64] {
        let before = self.numbers.len();
        self.numbers.resize(before + self.width, 0.0);
        &mut self.numbers[before..]
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.numbers.len().checked_div(self.width).unwrap_or(0)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// How many numbers a row has.
    pub fn width(&self) -> usize {
        self.width
    }

    /// One row.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.numbers[row * self.width..(row + 1) * self.width]
    }

    /// All rows from one on.
    pub fn from(&self, row: usize) -> impl Iterator<Item = &[f64]> {
        self.numbers[row * self.width..].chunks_exact(self.width.max(1))
    }

    // ANCHOR: rotate
    /// Turns a row and the one above it by an angle (Givens) so that the lower one loses its number
    /// in one of the first three columns. Left of `start`, three or more, both have zeros but from this
    /// column to the third.
    #[inline(always)]
    pub(super) fn rotate(&mut self, row: usize, column: usize, start: usize) {
        let (above, below) = self.numbers.split_at_mut(row * self.width);
        let upper = &mut above[(row - 1) * self.width..];
        let lower = &mut below[..self.width];
        let length = upper[column].hypot(lower[column]);
        if length == 0.0 {
            return;
        }
        let (cosine, sine) = (upper[column] / length, lower[column] / length);
        let turn = |(upper, lower): (&mut f64, &mut f64)| {
            let (a, b) = (*upper, *lower);
            *upper = cosine * a + sine * b;
            *lower = cosine * b - sine * a;
        };
        let landmark = column..3.min(start);
        upper[landmark.clone()].iter_mut().zip(&mut lower[landmark]).for_each(turn);
        upper[start..].iter_mut().zip(&mut lower[start..]).for_each(turn);
        lower[column] = 0.0;
    }
    // ANCHOR_END: rotate
}

impl Rows {
    // ANCHOR: compress
    /// Turns all rows by reflections of Householder into as few as there are columns before the
    /// last one, which is the residual, and drops those that say nothing of the columns any more.
    /// Implements {eq:track-compressed}.
    /// Fewer rows than columns stay as they are.
    pub fn compress(&mut self) {
        let (width, count) = (self.width, self.len());
        if count < width.max(1) {
            return;
        }
        let mut sums = vec![0.0; width];
        let mut done = 0;
        for column in 0..width - 1 {
            done += usize::from(self.reflect(done, column, &mut sums));
        }
        self.numbers.truncate(done * width);
    }
    // ANCHOR_END: compress

    // ANCHOR: reflect
    /// Reflects the rows from one on so that only this one has a number in a column. False when none
    /// had.
    fn reflect(&mut self, first: usize, column: usize, sums: &mut [f64]) -> bool {
        let width = self.width;
        let end = ((first + 1) * width).min(self.numbers.len());
        let (above, below) = self.numbers.split_at_mut(end);
        let Some(top) = above.get_mut(first * width..) else { return false };
        let largest = |rows: &[f64]| {
            rows.chunks_exact(width).fold(0.0_f64, |largest, row| largest.max(row[column].abs()))
        };
        let (head, unit) = (top[column], largest(below).max(top[column].abs()));
        if largest(below) == 0.0 {
            return head != 0.0;
        }
        // What rounding has left may be so small that its square is not a number any more.
        let (head, weight) = (head / unit, |row: &[f64]| row[column] / unit);
        let square: f64 = below.chunks_exact(width).map(|row| weight(row).powi(2)).sum();
        let length = (head * head + square).sqrt().copysign(head);
        let pivot = head + length;
        sums.fill(0.0);
        let add = |sums: &mut [f64], weight: f64, row: &[f64]| {
            sums.iter_mut().zip(row).for_each(|(sum, number)| *sum += weight * number);
        };
        add(&mut sums[column..], pivot, &top[column..]);
        below
            .chunks_exact(width)
            .for_each(|row| add(&mut sums[column..], weight(row), &row[column..]));
        let factor = -2.0 / (pivot * pivot + square);
        sums[column..].iter_mut().for_each(|sum| *sum *= factor);
        add(&mut top[column..], pivot, &sums[column..]);
        for row in below.chunks_exact_mut(width) {
            let weight = weight(row);
            add(&mut row[column..], weight, &sums[column..]);
            row[column] = 0.0;
        }
        true
    }
    // ANCHOR_END: reflect

    /// The columns before the last one, and the last one; without columns both are empty.
    pub fn system(&self) -> (DMatrix<f64>, DVector<f64>) {
        if self.width == 0 {
            return (DMatrix::zeros(0, 0), DVector::zeros(0));
        }
        let rows = DMatrix::from_row_slice(self.len(), self.width, &self.numbers);
        let residual = rows.column(self.width - 1).into_owned();
        (rows.remove_column(self.width - 1), residual)
    }
}
