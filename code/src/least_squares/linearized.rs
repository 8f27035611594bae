//! Residuals and derivatives of many factors, as a linear system takes them.

use nalgebra::SMatrix;

/// Linearized factors of one group, each of the same shape. Residuals and derivatives are weighted
/// by the root of their kernel's weight, so that plain sums of products make gradient and Hessian.
#[derive(Debug, Clone, Default)]
pub struct Linearized {
    /// How many numbers the residual of each factor has.
    pub rows: usize,
    /// How many variables each factor has.
    pub slots: usize,
    /// The residuals, one after the other.
    pub residuals: Vec<f64>,
    /// The cost of all of them.
    pub cost: f64,
    /// For each slot the derivatives by that variable, row by row.
    jacobians: Vec<Slot>,
}

#[derive(Debug, Clone, Default)]
struct Slot {
    columns: usize,
    rows: Vec<f64>,
}

impl Linearized {
    /// Nothing, of factors with so many rows and with variables of these dimensions. What was
    /// there is forgotten; its memory is kept.
    pub fn clear(&mut self, rows: usize, columns: &[usize]) {
        (self.rows, self.slots, self.cost) = (rows, columns.len(), 0.0);
        self.residuals.clear();
        self.jacobians.resize_with(self.jacobians.len().max(columns.len()), Slot::default);
        for (slot, columns) in self.jacobians.iter_mut().zip(columns) {
            slot.rows.clear();
            slot.columns = *columns;
        }
    }

    /// Room for so many factors more.
    pub fn reserve(&mut self, factors: usize) {
        let rows = factors * self.rows;
        self.residuals.reserve_exact(rows);
        for slot in &mut self.jacobians[..self.slots] {
            slot.rows.reserve_exact(rows * slot.columns);
        }
    }

    /// Appends the rows of a block of derivatives, times a factor.
    #[inline(always)]
    pub fn append_rows<const R: usize, const C: usize>(
        &mut self,
        slot: usize,
        factor: f64,
        block: &SMatrix<f64, R, C>,
    ) {
        let rows: [[f64; C]; R] =
            std::array::from_fn(|row| std::array::from_fn(|column| factor * block[(row, column)]));
        self.jacobians[slot].rows.extend_from_slice(rows.as_flattened());
    }

    /// How many factors there are.
    pub fn len(&self) -> usize {
        self.residuals.len() / self.rows.max(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.residuals.is_empty()
    }

    /// Columns of the derivatives by the variables in a slot.
    pub fn columns(&self, slot: usize) -> usize {
        self.jacobians[slot].columns
    }

    /// The derivatives by the variables in a slot, row by row.
    #[inline]
    pub fn jacobian(&self, slot: usize) -> &[f64] {
        &self.jacobians[slot].rows
    }

    /// The same as rows of a length that is known when compiling; no rows when it is another one.
    #[inline(always)]
    pub fn rows_of<const C: usize>(&self, slot: usize) -> &[[f64; C]] {
        self.jacobian(slot).as_chunks().0
    }

    /// The memory that it holds, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let numbers: usize = self.jacobians.iter().map(|slot| slot.rows.capacity()).sum();
        size_of::<f64>() * (numbers + self.residuals.capacity())
    }

    /// The first factor with a number that is not finite.
    pub fn not_finite(&self) -> Option<usize> {
        let first = |numbers: &[f64], each: usize| {
            let place = numbers.iter().position(|number| !number.is_finite())?;
            Some(place / each.max(1))
        };
        let jacobians = self.jacobians[..self.slots].iter();
        jacobians
            .filter_map(|slot| first(&slot.rows, self.rows * slot.columns))
            .chain(first(&self.residuals, self.rows))
            .min()
    }
}
