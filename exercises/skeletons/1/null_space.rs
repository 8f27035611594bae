//! Without the landmark. Edition 1.
//!
//! `cargo test -p exercises null_space`

use nalgebra::{DMatrix, DVector};

/// The cosine c and the sine s that turn the column (a, b) to (√(a² + b²), 0).
pub fn givens(a: f64, b: f64) -> (f64, f64) {
    let _ = (a, b);
    todo!("a rotation that leaves the length in the first number and nothing in the second")
}

/// Nᵀ H_x and Nᵀ r of the equations r = H_x δx + H_f δf + ν, without the landmark. `None` when it
/// is not fixed.
pub fn project_out(
    by_states: DMatrix<f64>,
    by_landmark: DMatrix<f64>,
    residual: DVector<f64>,
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let _ = (by_states, by_landmark, residual);
    todo!("rotations of rows, until only three of them speak of the landmark")
}

/// The δx that the track proposes, with a prior on it and none on the landmark. `None` when the
/// landmark is not fixed.
pub fn correction(
    prior_information: DMatrix<f64>,
    by_states: DMatrix<f64>,
    by_landmark: DMatrix<f64>,
    residual: DVector<f64>,
) -> Option<DVector<f64>> {
    let _ = (prior_information, by_states, by_landmark, residual);
    todo!("what the prior and the projected equations agree on")
}
