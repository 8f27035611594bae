//! The directions in which a filter may know nothing, and what it has come to know along them.

use nalgebra::{DMatrix, SMatrix};

// ANCHOR: constrained
/// Rows whose product with N, the free directions, is `wanted`, and which differ from the given ones
/// as little as can be: H − (H N − wanted)(Nᵀ N)⁻¹ Nᵀ. Implements {eq:constrained-jacobian}.
/// `None` when the directions depend on one another.
pub fn constrained(
    rows: &DMatrix<f64>,
    free: &DMatrix<f64>,
    wanted: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    // With columns of length one, a small pivot is a direction that the others make up.
    let lengths: Vec<f64> = free.column_iter().map(|column| column.norm()).collect();
    let scaled = |matrix: &DMatrix<f64>| {
        DMatrix::from_fn(matrix.nrows(), lengths.len(), |row, column| {
            matrix[(row, column)] / lengths[column]
        })
    };
    let unit = scaled(free);
    let gram = unit.tr_mul(&unit).cholesky()?;
    if gram.l_dirty().diagonal().iter().any(|pivot| *pivot < INDEPENDENT) {
        return None;
    }
    let excess = rows * &unit - scaled(wanted);
    Some(rows - excess * gram.solve(&unit.transpose()))
}
// ANCHOR_END: constrained

/// The least part of a unit vector along a direction that the others may not make up.
const INDEPENDENT: f64 = 1e-7;

// ANCHOR: spurious
/// What rows claim of directions that should be free.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Claimed {
    /// For each direction n the information |H n|² that the rows add along it.
    pub gained: [f64; 4],
    /// For each direction the sum of |H_i n_i|² over the coordinates: what it would be if nothing
    /// cancelled. What is gained is judged by it.
    pub whole: [f64; 4],
}

impl Claimed {
    /// What the whitened rows H claim along the free directions N.
    pub fn of(rows: &DMatrix<f64>, free: &DMatrix<f64>) -> Self {
        let mut claimed = Self::default();
        let seen = rows * free;
        let squares: Vec<f64> = rows.column_iter().map(|column| column.norm_squared()).collect();
        for (direction, along) in free.column_iter().take(4).enumerate() {
            claimed.gained[direction] = seen.column(direction).norm_squared();
            let parts = along.iter().zip(&squares);
            claimed.whole[direction] = parts.map(|(part, square)| part * part * square).sum();
        }
        claimed
    }

    /// What is gained along shifts, as a part of the whole; `None` where no rows say anything.
    pub fn part_of_shifts(&self) -> Option<f64> {
        let sum = |[x, y, z, _]: [f64; 4]| x + y + z;
        part(sum(self.gained), sum(self.whole))
    }

    /// The same along the turn about the vertical.
    pub fn part_of_turn(&self) -> Option<f64> {
        part(self.gained[3], self.whole[3])
    }

    /// Both added up.
    pub fn add(&mut self, other: &Self) {
        let add = |sums: &mut [f64; 4], more: &[f64; 4]| {
            sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        };
        add(&mut self.gained, &other.gained);
        add(&mut self.whole, &other.whole);
    }
}
// ANCHOR_END: spurious

fn part(gained: f64, whole: f64) -> Option<f64> {
    (whole > 0.0).then(|| gained / whole)
}

// ANCHOR: certificate
/// The 4×4 matrix Nᵀ P⁻¹ N, {eq:certificate}: what a covariance P claims to know along the directions
/// N. `None` when P is not positive definite, or when N has not four columns and as many rows as P.
pub fn certificate(covariance: &DMatrix<f64>, free: &DMatrix<f64>) -> Option<SMatrix<f64, 4, 4>> {
    if free.shape() != (covariance.nrows(), 4) {
        return None;
    }
    // In standard deviations, so that radians and metres have the same size.
    let sigmas = covariance.diagonal().map(f64::sqrt);
    let scaled = DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |row, column| {
        covariance[(row, column)] / (sigmas[row] * sigmas[column])
    });
    let free = DMatrix::from_fn(free.nrows(), 4, |row, column| free[(row, column)] / sigmas[row]);
    let whitened = scaled.cholesky()?.l().solve_lower_triangular(&free)?;
    let information = whitened.tr_mul(&whitened);
    Some(SMatrix::from_fn(|row, column| information[(row, column)]))
}
// ANCHOR_END: certificate
