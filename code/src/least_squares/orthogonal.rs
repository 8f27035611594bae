//! The triangle of a sparse Jacobian, by orthogonal elimination of one variable after the other.

use nalgebra::{DMatrix, DVector};

use super::Columns;
use super::group::Point;
use super::null_space::{NullSpace, check_gap};
use super::ordering::{minimum_degree, neighbours};
use super::problem::{Buffer, Problem};
use super::solver::SolveError;
use super::sparse_rows::SparseRows;
use super::spectrum::scale_of;
use super::square_root::{Piece, eliminate_fronts};

/// Weak measurements of zero of every column, far above rounding and far below anything that is
/// seen, make the triangle regular.
const REGULAR: f64 = 1e-11;

/// Inverse iterations for each direction.
const ITERATIONS: usize = 16;

/// A sparse Jacobian with columns of length one, in the order of their elimination, and its
/// triangle.
pub(super) struct Triangle {
    rows: SparseRows<f64>,
    scale: DVector<f64>,
    /// The place of each column of the problem in the order of elimination.
    place: Vec<usize>,
    pieces: Vec<Piece<f64>>,
}

impl Triangle {
    /// Eliminates every variable of a problem.
    pub(super) fn of(problem: &Problem, at: Point, columns: &Columns) -> Result<Self, SolveError> {
        let mut rows = SparseRows::default();
        problem.each_row(at, columns, &mut Buffer::default(), |row| {
            rows.push(row.entries.iter().copied());
        })?;
        let mut squares = DVector::<f64>::zeros(columns.count);
        for (column, slope) in rows.entries() {
            squares[*column] += slope * slope;
        }
        let scale = squares.map(|square| scale_of(square.sqrt()));
        let blocks = &columns.blocks;
        let coupled = rows.iter().map(|row| {
            row.iter().map(|(column, _)| columns.block_with(*column)).collect::<Vec<_>>()
        });
        let sizes: Vec<usize> = blocks.iter().map(ExactSizeIterator::len).collect();
        let order = minimum_degree(neighbours(blocks.len(), coupled), &sizes);
        let mut place = vec![0; columns.count];
        let in_order = order.iter().flat_map(|block| blocks[*block].clone());
        in_order.zip(0..).for_each(|(column, new)| place[column] = new);
        for (column, slope) in rows.entries_mut() {
            *slope *= scale[*column];
            *column = place[*column];
        }
        let sizes: Vec<usize> = order.iter().map(|block| sizes[*block]).collect();
        let mut regular = rows.clone();
        (0..columns.count).for_each(|column| regular.push([(column, REGULAR)]));
        let numbers = 0..regular.len();
        let (pieces, _) = eliminate_fronts(&mut regular, numbers, &sizes);
        Ok(Self { rows, scale, place, pieces })
    }

    // ANCHOR: inverse_iteration
    /// The null space, one direction after the other: what inverse iteration leads to beside those
    /// found before, until a singular value is not zero.
    pub(super) fn null_space(&self) -> Result<NullSpace, SolveError> {
        let largest = self.largest();
        let mut found: Vec<DVector<f64>> = Vec::new();
        while found.len() < self.scale.len() {
            let mut direction = self.start(found.len());
            for _ in 0..ITERATIONS {
                beside(&found, &mut direction);
                self.solve(&mut direction);
                beside(&found, &mut direction);
            }
            let value = self.product(&direction).norm() / largest;
            if !value.is_finite() {
                return Err(SolveError::OutOfRange);
            }
            if !check_gap(value)? {
                return Ok(self.with(&found, Some(value)));
            }
            found.push(direction);
        }
        Ok(self.with(&found, None))
    }
    // ANCHOR_END: inverse_iteration

    fn with(&self, found: &[DVector<f64>], least_seen: Option<f64>) -> NullSpace {
        let basis = match found {
            [] => DMatrix::zeros(self.scale.len(), 0),
            _ => DMatrix::from_columns(found).select_rows(&self.place),
        };
        NullSpace::new(basis, self.scale.clone(), least_seen)
    }

    /// Numbers without a pattern that a problem could share.
    fn start(&self, number: usize) -> DVector<f64> {
        let seed = 1 + number;
        DVector::from_fn(self.scale.len(), |row, _| {
            ((1 + row * seed) as f64 * 0.618_033_988_749_894_9).fract() - 0.5
        })
    }

    /// The largest singular value, to a few percent.
    fn largest(&self) -> f64 {
        let mut direction = self.start(0);
        let mut square = 0.0;
        for _ in 0..ITERATIONS {
            direction.normalize_mut();
            let image = self.product(&direction);
            square = image.norm_squared();
            direction.fill(0.0);
            for (row, value) in self.rows.iter().zip(image.iter()) {
                for (column, slope) in row {
                    direction[*column] += slope * value;
                }
            }
        }
        square.sqrt().max(f64::MIN_POSITIVE)
    }

    /// The Jacobian times a vector.
    fn product(&self, vector: &DVector<f64>) -> DVector<f64> {
        let entry =
            |row: &[(usize, f64)]| row.iter().map(|(column, slope)| slope * vector[*column]).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(entry))
    }

    // ANCHOR: solve_twice
    /// Solves RᵀR x = b in place, forward through the pieces and back.
    fn solve(&self, vector: &mut DVector<f64>) {
        for Piece { columns, rows, own } in &self.pieces {
            for own in 0..*own {
                let value = vector[columns[own]] / rows.at(own, own);
                vector[columns[own]] = value;
                for at in own + 1..columns.len() {
                    vector[columns[at]] -= rows.at(own, at) * value;
                }
            }
        }
        for Piece { columns, rows, own } in self.pieces.iter().rev() {
            for own in (0..*own).rev() {
                let later = own + 1..columns.len();
                let known: f64 = later.map(|at| rows.at(own, at) * vector[columns[at]]).sum();
                vector[columns[own]] = (vector[columns[own]] - known) / rows.at(own, own);
            }
        }
    }
    // ANCHOR_END: solve_twice
}

/// Makes a vector orthogonal to others of length one, and of length one.
fn beside(others: &[DVector<f64>], vector: &mut DVector<f64>) {
    // Twice is enough for orthogonality to rounding.
    for other in others.iter().chain(others) {
        vector.axpy(-other.dot(vector), other, 1.0);
    }
    vector.normalize_mut();
}
