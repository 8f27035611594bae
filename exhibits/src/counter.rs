//! Counts products of two numbers while they are computed; quotients count as products. Adding and transposing are
//! free.

use std::cell::Cell;

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, Vector3};
use vislam::manifold::so3;

/// Computes and counts.
#[derive(Default)]
pub struct Counter(Cell<usize>);

impl Counter {
    /// The products so far.
    pub fn products(&self) -> usize {
        self.0.get()
    }

    /// Takes note of products that were computed elsewhere.
    pub fn count(&self, products: usize) {
        self.0.set(self.0.get() + products);
    }

    pub fn times<const R: usize, const K: usize, const C: usize>(
        &self,
        a: &SMatrix<f64, R, K>,
        b: &SMatrix<f64, K, C>,
    ) -> SMatrix<f64, R, C> {
        self.count(R * K * C);
        a * b
    }

    pub fn scaled<const R: usize, const C: usize>(
        &self,
        factor: f64,
        matrix: &SMatrix<f64, R, C>,
    ) -> SMatrix<f64, R, C> {
        self.count(R * C);
        factor * matrix
    }

    /// Each entry of the product with c^ has two products.
    pub fn times_hat(&self, a: &Matrix3<f64>, c: &Vector3<f64>) -> Matrix3<f64> {
        self.count(18);
        a * so3::hat(c)
    }

    /// The same for matrices of any size.
    pub fn product(&self, a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
        self.count(a.nrows() * a.ncols() * b.ncols());
        a * b
    }

    /// The matrix less the square of another one, of which one half is computed.
    pub fn less_square(&self, matrix: &mut DMatrix<f64>, root: &DMatrix<f64>) {
        for (column, right) in root.column_iter().enumerate() {
            for (row, left) in root.column_iter().enumerate().skip(column) {
                self.count(root.nrows());
                matrix[(row, column)] -= left.dot(&right);
                matrix[(column, row)] = matrix[(row, column)];
            }
        }
    }

    /// The lower triangle L with L Lᵀ equal to a matrix that is positive definite.
    pub fn cholesky(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let size = matrix.nrows();
        let mut lower = DMatrix::zeros(size, size);
        for column in 0..size {
            for row in column..size {
                self.count(column);
                let known = |row: usize| lower.view((row, 0), (1, column));
                let rest: f64 = matrix[(row, column)] - known(row).dot(&known(column));
                lower[(row, column)] = if row == column {
                    rest.sqrt()
                } else {
                    self.count(1);
                    rest / lower[(column, column)]
                };
            }
        }
        lower
    }

    /// L⁻¹ times some columns, for a lower triangle L.
    pub fn solve_lower(&self, lower: &DMatrix<f64>, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let size = lower.nrows();
        self.count(columns.ncols() * size * (size + 1) / 2);
        lower.solve_lower_triangular(columns).expect("a triangle without zeros on its diagonal")
    }

    /// The transpose of some columns times a vector.
    pub fn transposed_times(&self, columns: &DMatrix<f64>, vector: &DVector<f64>) -> DVector<f64> {
        self.count(columns.len());
        columns.tr_mul(vector)
    }
}
