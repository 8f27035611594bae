//! Residuals and derivatives of many factors, as a linear system takes them.

use nalgebra::{SMatrix, SVector};

/// Linearized factors of one group, each of the same shape. Residuals and derivatives are weighted
/// by the root of their kernel's weight, so that plain sums of products make gradient and Hessian.
#[derive(Debug, Clone, Default)]
pub struct Linearized {
    rows: usize,
    slots: usize,
    len: usize,
    /// The cost of all of them.
    pub cost: f64,
    residuals: Vec<f64>,
    /// For each slot the derivatives by that variable, row by row.
    jacobians: Vec<Slot>,
}

#[derive(Debug, Clone, Default)]
struct Slot {
    columns: usize,
    /// How many rows of each factor may differ from zero.
    filled: usize,
    entries: Vec<f64>,
}

impl Linearized {
    /// Room for so many factors, with so many rows and with variables of these dimensions. What
    /// was there is void; memory is taken only when there has never been as much.
    pub fn begin(&mut self, len: usize, rows: usize, columns: &[usize]) {
        (self.len, self.rows, self.slots, self.cost) = (len, rows, columns.len(), 0.0);
        grow(&mut self.residuals, len * rows);
        if self.jacobians.len() < columns.len() {
            self.jacobians.resize_with(columns.len(), Slot::default);
        }
        for (slot, columns) in self.jacobians.iter_mut().zip(columns) {
            (slot.columns, slot.filled) = (*columns, rows);
            grow(&mut slot.entries, len * rows * columns);
        }
    }

    /// Writes the residual of a factor, times a weight.
    #[inline(always)]
    pub fn write_residual<const R: usize>(
        &mut self,
        factor: usize,
        weight: f64,
        residual: &SVector<f64, R>,
    ) {
        let place = &mut self.residuals[factor * R..(factor + 1) * R];
        place.copy_from_slice((weight * residual).as_slice());
    }

    /// Writes the derivatives of a factor by one of its variables, times a weight.
    #[inline(always)]
    pub fn write_jacobian<const R: usize, const C: usize>(
        &mut self,
        factor: usize,
        slot: usize,
        weight: f64,
        block: &SMatrix<f64, R, C>,
    ) {
        let rows: [[f64; C]; R] =
            std::array::from_fn(|row| std::array::from_fn(|column| weight * block[(row, column)]));
        let place = factor * R * C..(factor + 1) * R * C;
        self.jacobians[slot].entries[place].copy_from_slice(rows.as_flattened());
    }

    /// Writes the residuals of all factors.
    pub fn write_residual_slice(&mut self, residuals: &[f64]) {
        self.residuals[..residuals.len()].copy_from_slice(residuals);
    }

    /// Says that in a slot all rows of each factor behind so many are zero.
    pub fn fill_rows(&mut self, slot: usize, filled: usize) {
        let Slot { columns, filled: rows, entries } = &mut self.jacobians[slot];
        *rows = filled.min(self.rows);
        for factor in entries.chunks_exact_mut(self.rows * *columns).take(self.len) {
            factor[*rows * *columns..].fill(0.0);
        }
    }

    /// How many rows of each factor may differ from zero in a slot.
    #[inline(always)]
    pub fn filled(&self, slot: usize) -> usize {
        self.jacobians[slot].filled
    }

    /// Writes the first rows of a column of the derivatives by the variables in a slot.
    pub fn write_column(&mut self, slot: usize, column: usize, rows: impl Iterator<Item = f64>) {
        let Slot { columns, entries, .. } = &mut self.jacobians[slot];
        for (row, slope) in rows.enumerate() {
            entries[row * *columns + column] = slope;
        }
    }

    /// How many factors there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// How many numbers the residual of each factor has.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The residuals, one after the other.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals[..self.len * self.rows]
    }

    /// Columns of the derivatives by the variables in a slot.
    pub fn columns(&self, slot: usize) -> usize {
        self.jacobians[slot].columns
    }

    /// The derivatives by the variables in a slot, row by row.
    #[inline]
    pub fn jacobian(&self, slot: usize) -> &[f64] {
        let Slot { columns, entries, .. } = &self.jacobians[slot];
        &entries[..self.len * self.rows * columns]
    }

    /// The same, cut into rows of a length that is known when compiling. Where the variables have another
    /// number of columns, these are not its rows, and as a rule not as many.
    #[inline(always)]
    pub fn rows_of<const C: usize>(&self, slot: usize) -> &[[f64; C]] {
        self.jacobian(slot).as_chunks().0
    }

    /// The memory that it holds, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let entries: usize = self.jacobians.iter().map(|slot| slot.entries.capacity()).sum();
        size_of::<f64>() * (entries + self.residuals.capacity())
    }

    /// The first factor with a number that is not finite.
    pub fn not_finite(&self) -> Option<usize> {
        // Without a place to stop at, many numbers are asked in one instruction.
        let is_any = |numbers: &[f64]| numbers.iter().fold(false, |any, n| any | !n.is_finite());
        let first = |numbers: &[f64], each: usize| {
            if !is_any(numbers) {
                return None;
            }
            Some(numbers.iter().position(|number| !number.is_finite())? / each.max(1))
        };
        (0..self.slots)
            .filter_map(|slot| first(self.jacobian(slot), self.rows * self.columns(slot)))
            .chain(first(self.residuals(), self.rows))
            .min()
    }
}

/// Makes a list at least this long.
fn grow(list: &mut Vec<f64>, len: usize) {
    if list.len() < len {
        list.resize(len, 0.0);
    }
}
