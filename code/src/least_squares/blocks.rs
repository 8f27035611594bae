//! The Schur complement of the landmarks: its blocks, its Cholesky factor and the one kernel that
//! both elimination and factorization spend their time in.

use nalgebra::DMatrix;

// ANCHOR: block
/// A D×D block of the Schur complement, column by column.
pub type Block<const D: usize> = [[f64; D]; D];
// ANCHOR_END: block

/// Adds to the upper left part of a block the product L Rᵀ of two matrices with N and M rows, given
/// column by column, times a sign.
///
/// Nearly all of the arithmetic of bundle adjustment happens here: two columns for a
/// pair of cameras that share a point, D and more in the factorization. The compiler
/// keeps three columns of the block in vector registers while it goes through L and R.
/// They are taken a third of the block apart, because it would tangle neighbours.
// ANCHOR: kernel
#[inline(always)]
pub fn add_product<const D: usize, const N: usize, const M: usize>(
    block: &mut Block<D>,
    sign: f64,
    l: &[[f64; N]],
    r: &[[f64; M]],
) {
    let (left, others) = block[..M].split_at_mut(M / 3);
    let (middle, others) = others.split_at_mut(M / 3);
    let (right, left_over) = others.split_at_mut(M / 3);
    for (i, ((x, y), z)) in left.iter_mut().zip(middle).zip(right).enumerate() {
        let (x, y, z) = (first_mut(x), first_mut(y), first_mut(z));
        let mut sums = (*x, *y, *z);
        for (l, r) in l.iter().zip(r) {
            add_multiple(&mut sums.0, sign * r[i], l);
            add_multiple(&mut sums.1, sign * r[i + M / 3], l);
            add_multiple(&mut sums.2, sign * r[i + M / 3 * 2], l);
        }
        (*x, *y, *z) = sums;
    }
    for (i, x) in left_over.iter_mut().map(first_mut).enumerate() {
        l.iter().zip(r).for_each(|(l, r)| add_multiple(x, sign * r[i + M / 3 * 3], l));
    }
}
// ANCHOR_END: kernel

/// The first numbers of an array.
#[inline(always)]
pub fn first<const D: usize, const N: usize>(array: &[f64; D]) -> &[f64; N] {
    const { assert!(N <= D) };
    array.first_chunk().expect("there are as many")
}

#[inline(always)]
pub fn first_mut<const D: usize, const N: usize>(array: &mut [f64; D]) -> &mut [f64; N] {
    const { assert!(N <= D) };
    array.first_chunk_mut().expect("there are as many")
}

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

// ANCHOR: schur_complement
/// The lower triangle of the Schur complement S, or of its Cholesky factor, as blocks.
///
/// A row of blocks begins at the first variable that shares a landmark or a factor with the row's
/// variable, that of the border at the first of all.
/// Elimination writes nothing to the left of it, and neither does the factorization.
#[derive(Debug, Clone)]
pub struct SchurComplement<const D: usize> {
    /// Column of the first block in each row.
    first: Vec<usize>,
    /// Where each row begins in `blocks`, and where the last one ends.
    start: Vec<usize>,
    blocks: Vec<Block<D>>,
}
// ANCHOR_END: schur_complement

impl<const D: usize> SchurComplement<D> {
    /// A system whose rows of blocks begin at these columns, at or before the diagonal.
    pub fn new(first: Vec<usize>) -> Self {
        let mut start = vec![0];
        for (row, first) in first.iter().enumerate() {
            start.push(start[row] + row + 1 - first);
        }
        let blocks = vec![[[0.0; D]; D]; start[first.len()]];
        Self { first, start, blocks }
    }

    /// Number of rows of blocks.
    pub fn rows(&self) -> usize {
        self.first.len()
    }

    /// Number of blocks that are kept.
    pub fn stored(&self) -> usize {
        self.blocks.len()
    }

    /// Makes all entries zero.
    pub fn clear(&mut self) {
        self.blocks.fill([[0.0; D]; D]);
    }

    /// The block of a row and a column that is not beyond the diagonal.
    #[inline]
    pub fn block(&mut self, row: usize, column: usize) -> &mut Block<D> {
        &mut self.blocks[self.start[row] + column - self.first[row]]
    }

    /// The block of a row on the diagonal.
    pub fn diagonal(&self, row: usize) -> &Block<D> {
        &self.blocks[self.start[row] + row - self.first[row]]
    }

    /// The blocks of a row up to the diagonal, and the column of the first of them.
    #[inline]
    pub fn row(&mut self, row: usize) -> (&mut [Block<D>], usize) {
        (&mut self.blocks[self.start[row]..self.start[row + 1]], self.first[row])
    }

    /// Makes a coordinate independent of all others, with a one on the diagonal.
    pub fn isolate(&mut self, row: usize, axis: usize) {
        for below in row..self.rows() {
            if self.first[below] <= row {
                self.block(below, row)[axis] = [0.0; D];
            }
        }
        let (blocks, _) = self.row(row);
        blocks.iter_mut().flatten().for_each(|column| column[axis] = 0.0);
        self.block(row, row)[axis][axis] = 1.0;
    }

    /// The whole symmetric matrix.
    pub fn to_matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(D * self.rows(), D * self.rows());
        for row in 0..self.rows() {
            for column in self.first[row]..=row {
                let block = &self.blocks[self.start[row] + column - self.first[row]];
                for (r, c) in (0..D).flat_map(|r| (0..D).map(move |c| (r, c))) {
                    let (r_all, c_all) = (D * row + r, D * column + c);
                    matrix[(r_all, c_all)] = block[c][r];
                    matrix[(c_all, r_all)] = block[c][r];
                }
            }
        }
        matrix
    }

    #[inline(always)]
    // ANCHOR: factorize
    /// Replaces S by its Cholesky factor L with S = L Lᵀ, row of blocks by row of blocks. On
    /// the diagonal of L stand the reciprocals.
    ///
    /// # Errors
    ///
    /// The first coordinate whose pivot is not above its entry of `smallest`.
    pub fn factorize(&mut self, smallest: &[[f64; D]]) -> Result<(), usize> {
        for (row, smallest) in smallest.iter().enumerate() {
            let (done, rest) = self.blocks.split_at_mut(self.start[row]);
            let first = self.first[row];
            for column in first..row {
                let other = &done[self.start[column]..self.start[column + 1]];
                let from = first.max(self.first[column]);
                let (left, block) = rest.split_at_mut(column - first);
                let shared = &other[from - self.first[column]..other.len() - 1];
                let left = &left[from - first..];
                add_product(&mut block[0], -1.0, left.as_flattened(), shared.as_flattened());
                divide_by_factor(&mut block[0], &other[other.len() - 1]);
            }
            let (left, block) = rest.split_at_mut(row - first);
            add_product(&mut block[0], -1.0, left.as_flattened(), left.as_flattened());
            factorize_block(&mut block[0], smallest).map_err(|axis| D * row + axis)?;
        }
        Ok(())
    }
    // ANCHOR_END: factorize

    // ANCHOR: solve_lower
    /// Solves L z = b in place, with the factor.
    pub fn solve_lower(&self, b: &mut [[f64; D]]) {
        for row in 0..self.rows() {
            let (done, rest) = b.split_at_mut(row);
            let blocks = &self.blocks[self.start[row]..self.start[row + 1]];
            let (diagonal, left) = blocks.split_last().expect("a row has its diagonal");
            for (block, z) in left.iter().zip(&done[self.first[row]..]) {
                for (column, z) in block.iter().zip(z) {
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
            let blocks = &self.blocks[self.start[row]..self.start[row + 1]];
            let (diagonal, left) = blocks.split_last().expect("a row has its diagonal");
            for axis in (0..D).rev() {
                for below in axis + 1..D {
                    rest[0][axis] -= diagonal[axis][below] * rest[0][below];
                }
                rest[0][axis] *= diagonal[axis][axis];
            }
            for (block, z) in left.iter().zip(&mut above[self.first[row]..]) {
                for (z, column) in z.iter_mut().zip(block) {
                    *z -= dot(column, &rest[0]);
                }
            }
        }
    }
    // ANCHOR_END: solve_upper
}

// ANCHOR: divide_by_factor
/// Block times the transposed inverse of a factored diagonal block.
#[inline(always)]
fn divide_by_factor<const D: usize>(block: &mut Block<D>, factor: &Block<D>) {
    for column in 0..D {
        let (done, rest) = block.split_at_mut(column);
        for (known, factor) in done.iter().zip(factor) {
            add_multiple(&mut rest[0], -factor[column], known);
        }
        for entry in &mut rest[0] {
            *entry *= factor[column][column];
        }
    }
}
// ANCHOR_END: divide_by_factor

// ANCHOR: factorize_block
/// The Cholesky factor of one block, of which the lower triangle is read and written.
#[inline(always)]
fn factorize_block<const D: usize>(block: &mut Block<D>, smallest: &[f64; D]) -> Result<(), usize> {
    for column in 0..D {
        let (done, rest) = block.split_at_mut(column);
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
// ANCHOR_END: factorize_block

/// The scalar product, in four sums that do not wait for each other.
#[inline(always)]
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let ((fours, rest), (other_fours, other_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in fours.iter().zip(other_fours) {
        (0..4).for_each(|lane| sums[lane] = multiply_add(a[lane], b[lane], sums[lane]));
    }
    let sum = (sums[0] + sums[2]) + (sums[1] + sums[3]);
    rest.iter().zip(other_rest).fold(sum, |sum, (a, b)| multiply_add(*a, *b, sum))
}
