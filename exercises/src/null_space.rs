//! Without the landmark. Edition 2.
//!
//! `cargo test -p exercises null_space`

use nalgebra::{DMatrix, DVector};

/// The cosine c and the sine s that turn the column (a, b) to (√(a² + b²), 0):
/// c a + s b is the length and c b − s a is zero. (1, 0) where a and b are both zero.
pub fn givens(a: f64, b: f64) -> (f64, f64) {
    let _ = (a, b);
    todo!("a rotation that leaves the length in the first number and nothing in the second")
}

/// A landmark was seen in M pictures. Its 2M residuals are r, predicted less measured and
/// whitened. To first order they become r + H_x δx + H_f δf when δx moves the states and δf
/// the landmark (3 numbers), and at the truth ν, noise of variance one. `by_states` is H_x, of
/// 2M rows and any number of columns; `by_landmark` is H_f, 2M×3; `residual` is r.
///
/// Gives Nᵀ H_x and Nᵀ r, of 2M − 3 rows, where the columns of N are orthonormal and
/// Nᵀ H_f = 0. Every such N is right. `None` when the rank of H_f is less than three: when M
/// is one, or the third singular value of H_f is not at least 1e-9 of the first, or the first
/// is zero.
pub fn project_out(
    by_states: DMatrix<f64>,
    by_landmark: DMatrix<f64>,
    residual: DVector<f64>,
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let _ = (by_states, by_landmark, residual);
    todo!("rotations of rows, until only three of them speak of the landmark")
}

/// The δx that the track proposes when nothing is known about its landmark in advance, and δx
/// is normal with mean zero and the inverse of `prior_information` (positive definite) for a
/// covariance. `None` as in `project_out`.
pub fn correction(
    prior_information: DMatrix<f64>,
    by_states: DMatrix<f64>,
    by_landmark: DMatrix<f64>,
    residual: DVector<f64>,
) -> Option<DVector<f64>> {
    let _ = (prior_information, by_states, by_landmark, residual);
    todo!("what the prior and the projected equations agree on")
}
