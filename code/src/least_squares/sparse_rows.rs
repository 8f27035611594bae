//! Rows of a matrix of which each names few columns.

use nalgebra::{DMatrix, RealField};

/// Rows as lists of columns and entries, one list behind the other.
#[derive(Debug, Clone)]
pub(crate) struct SparseRows<T> {
    entries: Vec<(usize, T)>,
    /// By row, where its entries end.
    ends: Vec<usize>,
}

impl<T> Default for SparseRows<T> {
    fn default() -> Self {
        Self { entries: Vec::new(), ends: Vec::new() }
    }
}

impl<T: RealField + Copy> SparseRows<T> {
    pub fn push(&mut self, row: impl IntoIterator<Item = (usize, T)>) {
        self.entries.extend(row);
        self.ends.push(self.entries.len());
    }

    pub fn len(&self) -> usize {
        self.ends.len()
    }

    pub fn row(&self, number: usize) -> &[(usize, T)] {
        let begin = if number == 0 { 0 } else { self.ends[number - 1] };
        &self.entries[begin..self.ends[number]]
    }

    pub fn iter(&self) -> impl Iterator<Item = &[(usize, T)]> {
        (0..self.len()).map(|number| self.row(number))
    }

    /// All entries of all rows.
    pub fn entries(&self) -> &[(usize, T)] {
        &self.entries
    }

    pub fn entries_mut(&mut self) -> &mut [(usize, T)] {
        &mut self.entries
    }

    /// The same rows, those whose first column comes first before others: a triangle beside another one is
    /// then turned as a triangle.
    pub fn by_first_column(&self) -> Self {
        let first = |row: &[(usize, T)]| row.iter().map(|(column, _)| *column).min();
        let firsts: Vec<Option<usize>> = self.iter().map(first).collect();
        let mut numbers: Vec<usize> = (0..self.len()).collect();
        numbers.sort_by_key(|number| firsts[*number]);
        let mut sorted = Self {
            entries: Vec::with_capacity(self.entries.len()),
            ends: Vec::with_capacity(self.len()),
        };
        numbers.iter().for_each(|number| sorted.push(self.row(*number).iter().copied()));
        sorted
    }

    /// The columns that rows name, ascending, and the rows with these alone.
    pub fn dense(&self) -> (Vec<usize>, DMatrix<T>) {
        let named = || self.entries.iter().map(|(column, _)| *column);
        let first = named().min().unwrap_or_default();
        let mut places = vec![usize::MAX; named().max().map_or(0, |last| last + 1 - first)];
        named().for_each(|column| places[column - first] = 0);
        let mut columns = Vec::new();
        for (column, place) in (first..).zip(&mut places).filter(|(_, place)| **place == 0) {
            *place = columns.len();
            columns.push(column);
        }
        let mut dense = DMatrix::zeros(self.len(), columns.len());
        for (number, row) in self.iter().enumerate() {
            for (column, slope) in row {
                dense[(number, places[column - first])] = *slope;
            }
        }
        (columns, dense)
    }
}
