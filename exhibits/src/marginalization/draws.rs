//! Random Gaussians over named blocks.

use nalgebra::{DMatrix, DVector};
use vislam::marginalization::{Block, Blocks, Information};

use crate::random::Random;

/// Blocks named 0, 1, 2, … of these dimensions.
pub fn blocks(dimensions: &[usize]) -> Blocks {
    let block = |(name, dimension): (usize, &usize)| Block { name, dimension: *dimension };
    Blocks::new(dimensions.iter().enumerate().map(block).collect()).expect("names differ")
}

pub fn matrix(random: &mut Random, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| random.normal(1.0))
}

pub fn vector(random: &mut Random, rows: usize) -> DVector<f64> {
    DVector::from_fn(rows, |_, _| random.normal(1.0))
}

/// A Gaussian in which all blocks are coupled.
pub fn gaussian(random: &mut Random, dimensions: &[usize]) -> Information<f64> {
    let dimension: usize = dimensions.iter().sum();
    let root = matrix(random, dimension + 3, dimension);
    let vector = vector(random, dimension);
    Information::new(blocks(dimensions), root.tr_mul(&root), vector).expect("it is symmetric")
}

/// Numbers with the mean zero and an information matrix.
pub fn scalars(matrix: DMatrix<f64>) -> Information<f64> {
    let count = matrix.nrows();
    Information::new(blocks(&vec![1; count]), matrix, DVector::zeros(count)).expect("symmetric")
}

/// The columns of some blocks.
pub fn columns(information: &Information<f64>, names: &[usize]) -> Vec<usize> {
    let own = |name: &usize| information.blocks().columns_of(*name).expect("a block");
    names.iter().flat_map(own).collect()
}

/// Rows and columns of a matrix.
pub fn part(matrix: &DMatrix<f64>, rows: &[usize], columns: &[usize]) -> DMatrix<f64> {
    matrix.select_rows(rows).select_columns(columns)
}

/// The inverse of a matrix; NaN where it has none.
pub fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = matrix.shape();
    let none = || DMatrix::from_element(rows, columns, f64::NAN);
    matrix.clone().try_inverse().unwrap_or_else(none)
}

/// Writes a matrix into some rows and columns of another one.
pub fn put(into: &mut DMatrix<f64>, rows: &[usize], columns: &[usize], from: &DMatrix<f64>) {
    for (r, row) in rows.iter().enumerate() {
        for (c, column) in columns.iter().enumerate() {
            into[(*row, *column)] = from[(r, c)];
        }
    }
}
