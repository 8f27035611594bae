//! The reduced camera system: its tiles, its Cholesky factor and the one kernel that both
//! elimination and factorization spend their time in.

use nalgebra::DMatrix;

// ANCHOR: tile
/// A D×D block of the reduced system, column by column.
pub type Tile<const D: usize> = [[f64; D]; D];
// ANCHOR_END: tile

/// Adds to a tile the product L Rᵀ of two matrices with D rows, given column by column,
/// times a sign.
///
/// Nearly all of the arithmetic of bundle adjustment happens here: three columns for a
/// pair of cameras that share a point, D and more in the factorization. The compiler
/// keeps three columns of the tile in vector registers while it goes through L and R.
/// They are taken a third of the tile apart, because it would tangle neighbours.
// ANCHOR: kernel
#[inline(always)]
pub fn add_product<const D: usize>(tile: &mut Tile<D>, sign: f64, l: &[[f64; D]], r: &[[f64; D]]) {
    let (first, others) = tile.split_at_mut(D / 3);
    let (second, others) = others.split_at_mut(D / 3);
    let (third, left_over) = others.split_at_mut(D / 3);
    for (i, ((x, y), z)) in first.iter_mut().zip(second).zip(third).enumerate() {
        let mut sums = (*x, *y, *z);
        for (l, r) in l.iter().zip(r) {
            add_multiple(&mut sums.0, sign * r[i], l);
            add_multiple(&mut sums.1, sign * r[i + D / 3], l);
            add_multiple(&mut sums.2, sign * r[i + D / 3 * 2], l);
        }
        (*x, *y, *z) = sums;
    }
    for (i, x) in left_over.iter_mut().enumerate() {
        l.iter().zip(r).for_each(|(l, r)| add_multiple(x, sign * r[i + D / 3 * 3], l));
    }
}
// ANCHOR_END: kernel

// ANCHOR: multiple
/// Adds a multiple of a vector.
#[inline(always)]
pub fn add_multiple<const D: usize>(sum: &mut [f64; D], factor: f64, vector: &[f64; D]) {
    for (sum, entry) in sum.iter_mut().zip(vector) {
        *sum = multiply_add(factor, *entry, *sum);
    }
}

/// a b + c, fused where the processor can: elsewhere a fused product is a slow function.
#[inline(always)]
pub fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}
// ANCHOR_END: multiple

// ANCHOR: reduced
/// The lower triangle of the reduced system S, or of its Cholesky factor, as tiles.
///
/// A row of tiles begins at the first camera that shares a point with the row's camera.
/// Elimination writes nothing to the left of it, and neither does the factorization.
#[derive(Debug, Clone)]
pub struct Reduced<const D: usize> {
    /// Column of the first tile in each row.
    first: Vec<usize>,
    /// Where each row begins in `tiles`, and where the last one ends.
    start: Vec<usize>,
    tiles: Vec<Tile<D>>,
}
// ANCHOR_END: reduced

impl<const D: usize> Reduced<D> {
    /// A system whose rows of tiles begin at these columns, at or before the diagonal.
    pub fn new(first: Vec<usize>) -> Self {
        let mut start = vec![0];
        for (row, first) in first.iter().enumerate() {
            start.push(start[row] + row + 1 - first);
        }
        let tiles = vec![[[0.0; D]; D]; start[first.len()]];
        Self { first, start, tiles }
    }

    /// Number of rows of tiles.
    pub fn rows(&self) -> usize {
        self.first.len()
    }

    /// Number of tiles that are kept.
    pub fn stored(&self) -> usize {
        self.tiles.len()
    }

    /// Makes all entries zero.
    pub fn clear(&mut self) {
        self.tiles.fill([[0.0; D]; D]);
    }

    /// The tile of a row and a column that is not beyond the diagonal.
    #[inline]
    pub fn tile(&mut self, row: usize, column: usize) -> &mut Tile<D> {
        &mut self.tiles[self.start[row] + column - self.first[row]]
    }

    /// The tiles of a row up to the diagonal, and the column of the first of them.
    #[inline]
    pub fn row(&mut self, row: usize) -> (&mut [Tile<D>], usize) {
        (&mut self.tiles[self.start[row]..self.start[row + 1]], self.first[row])
    }

    /// The whole symmetric matrix.
    pub fn to_matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(D * self.rows(), D * self.rows());
        for row in 0..self.rows() {
            for column in self.first[row]..=row {
                let tile = &self.tiles[self.start[row] + column - self.first[row]];
                for (r, c) in (0..D).flat_map(|r| (0..D).map(move |c| (r, c))) {
                    let (r_all, c_all) = (D * row + r, D * column + c);
                    matrix[(r_all, c_all)] = tile[c][r];
                    matrix[(c_all, r_all)] = tile[c][r];
                }
            }
        }
        matrix
    }

    // ANCHOR: factorize
    /// Replaces S by its Cholesky factor L with S = L Lᵀ, row of tiles by row of tiles. On
    /// the diagonal of L stand the reciprocals.
    ///
    /// # Errors
    ///
    /// The first coordinate whose pivot is not above its entry of `smallest`.
    pub fn factorize(&mut self, smallest: &[[f64; D]]) -> Result<(), usize> {
        for (row, smallest) in smallest.iter().enumerate() {
            let (done, rest) = self.tiles.split_at_mut(self.start[row]);
            let first = self.first[row];
            for column in first..row {
                let other = &done[self.start[column]..self.start[column + 1]];
                let from = first.max(self.first[column]);
                let (left, tile) = rest.split_at_mut(column - first);
                let shared = &other[from - self.first[column]..other.len() - 1];
                let left = &left[from - first..];
                add_product(&mut tile[0], -1.0, left.as_flattened(), shared.as_flattened());
                divide_by_factor(&mut tile[0], &other[other.len() - 1]);
            }
            let (left, tile) = rest.split_at_mut(row - first);
            add_product(&mut tile[0], -1.0, left.as_flattened(), left.as_flattened());
            factorize_tile(&mut tile[0], smallest).map_err(|axis| D * row + axis)?;
        }
        Ok(())
    }
    // ANCHOR_END: factorize

    // ANCHOR: solve_lower
    /// Solves L z = b in place, with the factor.
    pub fn solve_lower(&self, b: &mut [[f64; D]]) {
        for row in 0..self.rows() {
            let (done, rest) = b.split_at_mut(row);
            let tiles = &self.tiles[self.start[row]..self.start[row + 1]];
            let (diagonal, left) = tiles.split_last().expect("a row has its diagonal");
            for (tile, z) in left.iter().zip(&done[self.first[row]..]) {
                for (column, z) in tile.iter().zip(z) {
                    add_multiple(&mut rest[0], -z, column);
                }
            }
            for axis in 0..D {
                rest[0][axis] *= diagonal[axis][axis];
                for below in axis + 1..D {
                    rest[0][below] -= diagonal[axis][below] * rest[0][axis];
                }
            }
        }
    }
    // ANCHOR_END: solve_lower

    // ANCHOR: solve_upper
    /// Solves Lᵀ x = z in place, with the factor.
    pub fn solve_upper(&self, z: &mut [[f64; D]]) {
        for row in (0..self.rows()).rev() {
            let (above, rest) = z.split_at_mut(row);
            let tiles = &self.tiles[self.start[row]..self.start[row + 1]];
            let (diagonal, left) = tiles.split_last().expect("a row has its diagonal");
            for axis in (0..D).rev() {
                for below in axis + 1..D {
                    rest[0][axis] -= diagonal[axis][below] * rest[0][below];
                }
                rest[0][axis] *= diagonal[axis][axis];
            }
            for (tile, z) in left.iter().zip(&mut above[self.first[row]..]) {
                for (z, column) in z.iter_mut().zip(tile) {
                    *z -= dot(column, &rest[0]);
                }
            }
        }
    }
    // ANCHOR_END: solve_upper
}

// ANCHOR: divide_by_factor
/// Tile times the transposed inverse of a factored diagonal tile.
fn divide_by_factor<const D: usize>(tile: &mut Tile<D>, factor: &Tile<D>) {
    for column in 0..D {
        let (done, rest) = tile.split_at_mut(column);
        for (known, factor) in done.iter().zip(factor) {
            add_multiple(&mut rest[0], -factor[column], known);
        }
        for entry in &mut rest[0] {
            *entry *= factor[column][column];
        }
    }
}
// ANCHOR_END: divide_by_factor

// ANCHOR: factorize_tile
/// The Cholesky factor of one tile, of which the lower triangle is read and written.
fn factorize_tile<const D: usize>(tile: &mut Tile<D>, smallest: &[f64; D]) -> Result<(), usize> {
    for column in 0..D {
        let (done, rest) = tile.split_at_mut(column);
        for left in done.iter() {
            for row in column..D {
                rest[0][row] = multiply_add(-left[column], left[row], rest[0][row]);
            }
        }
        let pivot = rest[0][column];
        if pivot.is_nan() || pivot <= smallest[column] {
            return Err(column);
        }
        let reciprocal = 1.0 / pivot.sqrt();
        rest[0][column] = reciprocal;
        for entry in &mut rest[0][column + 1..] {
            *entry *= reciprocal;
        }
    }
    Ok(())
}
// ANCHOR_END: factorize_tile

/// The scalar product.
#[inline(always)]
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| multiply_add(*a, *b, sum))
}
