//! The triangle of a sparse Jacobian, by orthogonal elimination of one variable after the other.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::Columns;
use super::group::Point;
use super::null_space::{NullSpace, check_gap};
use super::problem::{Buffer, Problem};
use super::solver::SolveError;
use super::spectrum::scale_of;

/// Weak measurements of zero of every column, far above rounding and far below anything that is
/// seen, make the triangle regular.
const REGULAR: f64 = 1e-11;

/// Inverse iterations for each direction.
const ITERATIONS: usize = 12;

/// A sparse Jacobian with columns of length one, and its triangle.
pub(super) struct Triangle {
    rows: Vec<SparseRow>,
    scale: DVector<f64>,
    /// In the order of elimination.
    pieces: Vec<Piece>,
}

/// Columns and entries.
type SparseRow = Vec<(usize, f64)>;

// ANCHOR: piece
/// The rows of the triangle that belong to one variable.
struct Piece {
    /// The columns of the variable, then those of variables eliminated later.
    columns: Vec<usize>,
    /// As many rows as the variable has columns.
    rows: DMatrix<f64>,
}
// ANCHOR_END: piece

impl Triangle {
    /// Eliminates every variable of a problem.
    pub(super) fn of(problem: &Problem, at: Point, columns: &Columns) -> Result<Self, SolveError> {
        let mut rows: Vec<SparseRow> = Vec::with_capacity(problem.rows());
        problem.each_row(at, columns, &mut Buffer::default(), |row| {
            rows.push(row.entries.to_vec());
        })?;
        let mut squares = vec![0.0; columns.count];
        for (column, slope) in rows.iter().flatten() {
            squares[*column] += slope * slope;
        }
        let scale = squares.iter().map(|square: &f64| scale_of(square.sqrt()));
        let scale = DVector::from_iterator(columns.count, scale);
        for (column, slope) in rows.iter_mut().flatten() {
            *slope *= scale[*column];
        }
        let blocks = blocks(problem, columns);
        let order = order(&rows, &blocks);
        let pieces = eliminate(&rows, &blocks, &order);
        Ok(Self { rows, scale, pieces })
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
            _ => DMatrix::from_columns(found),
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
            |row: &SparseRow| row.iter().map(|(column, slope)| slope * vector[*column]).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(entry))
    }

    // ANCHOR: solve_twice
    /// Solves RᵀR x = b in place, forward through the pieces and back.
    fn solve(&self, vector: &mut DVector<f64>) {
        for Piece { columns, rows } in &self.pieces {
            for own in 0..rows.nrows() {
                let value = vector[columns[own]] / rows[(own, own)];
                vector[columns[own]] = value;
                for at in own + 1..columns.len() {
                    vector[columns[at]] -= rows[(own, at)] * value;
                }
            }
        }
        for Piece { columns, rows } in self.pieces.iter().rev() {
            for own in (0..rows.nrows()).rev() {
                let later = own + 1..columns.len();
                let known: f64 = later.map(|at| rows[(own, at)] * vector[columns[at]]).sum();
                vector[columns[own]] = (vector[columns[own]] - known) / rows[(own, own)];
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

/// The columns of each variable that has any.
fn blocks(problem: &Problem, columns: &Columns) -> Vec<Range<usize>> {
    let mut blocks: Vec<Range<usize>> = Vec::new();
    for index in 0..problem.values().len() {
        let coordinates = problem.values().coordinates_of(index).unwrap_or_default();
        let own = columns.select(coordinates);
        let start = blocks.last().map_or(0, |block| block.end);
        // What is tied to an earlier variable shares its columns.
        if own.first() == Some(&start) {
            blocks.push(start..start + own.len());
        }
    }
    blocks
}

// ANCHOR: order
/// An order of elimination that fills in little: first blocks of which no two share a row, those
/// with the fewest neighbours before others, as landmarks are; then the rest as they stand.
fn order(rows: &[SparseRow], blocks: &[Range<usize>]) -> Vec<usize> {
    let block_of = block_of(blocks);
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); blocks.len()];
    for row in rows {
        let mut named: Vec<usize> = row.iter().map(|(column, _)| block_of[*column]).collect();
        named.dedup();
        for one in &named {
            neighbours[*one].extend(named.iter().filter(|other| *other != one));
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let mut by_degree: Vec<usize> = (0..blocks.len()).collect();
    by_degree.sort_by_key(|block| neighbours[*block].len());
    let mut is_first = vec![false; blocks.len()];
    for block in by_degree {
        is_first[block] = !neighbours[block].iter().any(|neighbour| is_first[*neighbour]);
    }
    let first = (0..blocks.len()).filter(|block| is_first[*block]);
    first.chain((0..blocks.len()).filter(|block| !is_first[*block])).collect()
}
// ANCHOR_END: order

/// The block of each column.
fn block_of(blocks: &[Range<usize>]) -> Vec<usize> {
    blocks
        .iter()
        .enumerate()
        .flat_map(|(block, columns)| columns.clone().map(move |_| block))
        .collect()
}

// ANCHOR: eliminate
/// Front by front: all rows that contain the next variable are turned until only as many contain
/// it as it has columns. Those are its piece of the triangle; the others wait for the next of
/// their variables.
fn eliminate(rows: &[SparseRow], blocks: &[Range<usize>], order: &[usize]) -> Vec<Piece> {
    let block_of = block_of(blocks);
    let mut rank = vec![0; blocks.len()];
    order.iter().enumerate().for_each(|(place, block)| rank[*block] = place);
    let next = |columns: &mut dyn Iterator<Item = usize>| {
        columns.map(|column| rank[block_of[column]]).min()
    };
    let mut fronts: BTreeMap<usize, Vec<SparseRow>> = BTreeMap::new();
    let wait = |row: SparseRow, fronts: &mut BTreeMap<usize, Vec<SparseRow>>| {
        if let Some(place) = next(&mut row.iter().map(|(column, _)| *column)) {
            fronts.entry(place).or_default().push(row);
        }
    };
    rows.iter().for_each(|row| wait(row.clone(), &mut fronts));
    let mut pieces = Vec::with_capacity(order.len());
    for (place, block) in order.iter().enumerate() {
        let mut front = fronts.remove(&place).unwrap_or_default();
        front.extend(blocks[*block].clone().map(|column| vec![(column, REGULAR)]));
        let columns = columns_of(&front, &blocks[*block]);
        let triangle = triangular(&front, &columns);
        let own = blocks[*block].len();
        for row in own..triangle.nrows() {
            let entries = own.max(row)..columns.len();
            wait(entries.map(|at| (columns[at], triangle[(row, at)])).collect(), &mut fronts);
        }
        pieces.push(Piece { columns, rows: triangle.rows(0, own).into_owned() });
    }
    pieces
}
// ANCHOR_END: eliminate

/// The columns of a front: those of its own block first.
fn columns_of(front: &[SparseRow], own: &Range<usize>) -> Vec<usize> {
    let mut others: Vec<usize> = front.iter().flatten().map(|(column, _)| *column).collect();
    others.sort_unstable();
    others.dedup();
    own.clone().chain(others.into_iter().filter(|column| !own.contains(column))).collect()
}

/// The triangle of the rows of a front.
fn triangular(front: &[SparseRow], columns: &[usize]) -> DMatrix<f64> {
    let places: BTreeMap<usize, usize> =
        columns.iter().enumerate().map(|(place, column)| (*column, place)).collect();
    let mut dense = DMatrix::zeros(front.len(), columns.len());
    for (number, row) in front.iter().enumerate() {
        for (column, slope) in row {
            dense[(number, places[column])] = *slope;
        }
    }
    dense.qr().unpack_r()
}
