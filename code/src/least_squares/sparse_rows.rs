//! Rows of a matrix of which each names few columns.

use nalgebra::RealField;

use super::mirrors::Rows;

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
    /// Takes memory for so many rows with so many entries in all.
    pub fn reserve(&mut self, rows: usize, entries: usize) {
        self.ends.reserve(rows);
        self.entries.reserve(entries);
    }

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

    /// These numbers, rows whose first column comes first before others: a triangle beside another one is then
    /// turned as a triangle.
    pub fn by_first_column(&self, mut numbers: Vec<usize>) -> Vec<usize> {
        numbers.sort_by_cached_key(|number| self.first_column(*number));
        numbers
    }

    /// The first column that a row names.
    pub fn first_column(&self, number: usize) -> Option<usize> {
        self.row(number).iter().map(|(column, _)| *column).min()
    }

    /// The columns that some rows name, ascending, and the rows with these alone.
    pub fn dense(&self, numbers: &[usize]) -> (Vec<usize>, Rows<T>) {
        let rows = || numbers.iter().map(|number| self.row(*number));
        let mut columns: Vec<usize> = rows().flatten().map(|(column, _)| *column).collect();
        columns.sort_unstable();
        columns.dedup();
        let mut dense = Rows::zeros(numbers.len(), columns.len());
        for (number, row) in rows().enumerate() {
            for (column, slope) in row {
                dense.put(number, columns.partition_point(|known| known < column), *slope);
            }
        }
        (columns, dense)
    }
}
