//! Without the landmark.

use nalgebra::{DMatrix, DVector};

/// The cosine c and the sine s that turn the column (a, b) to (√(a² + b²), 0):
/// c a + s b is the length and c b − s a is zero. (1, 0) where a and b are both zero.
pub fn givens(a: f64, b: f64) -> (f64, f64) {
    let length = a.hypot(b);
    if length == 0.0 { (1.0, 0.0) } else { (a / length, b / length) }
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
    let (rows, columns) = by_states.shape();
    if rows < 3 {
        return None;
    }
    // One table of whole equations: what is rotated is H_f, H_x and r together.
    let mut table = DMatrix::zeros(rows, 3 + columns + 1);
    table.columns_mut(0, 3).copy_from(&by_landmark);
    table.columns_mut(3, columns).copy_from(&by_states);
    table.set_column(3 + columns, &residual);
    for column in 0..3 {
        for lower in (column + 1..rows).rev() {
            rotate(&mut table, column, lower);
        }
    }
    let sigmas = table.fixed_view::<3, 3>(0, 0).singular_values();
    let left = table.rows(3, rows - 3);
    (sigmas.min() >= 1e-9 * sigmas.max() && sigmas.max() > 0.0)
        .then(|| (left.columns(3, columns).into_owned(), left.column(3 + columns).into_owned()))
}

/// Turns a row and the one above it so that its entry in a column becomes zero.
fn rotate(table: &mut DMatrix<f64>, column: usize, lower: usize) {
    let (c, s) = givens(table[(lower - 1, column)], table[(lower, column)]);
    for mut entries in table.column_iter_mut() {
        let (a, b) = (entries[lower - 1], entries[lower]);
        (entries[lower - 1], entries[lower]) = (c * a + s * b, c * b - s * a);
    }
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
    let (by_states, residual) = project_out(by_states, by_landmark, residual)?;
    let information = prior_information + by_states.tr_mul(&by_states);
    Some(-information.cholesky()?.solve(&by_states.tr_mul(&residual)))
}
