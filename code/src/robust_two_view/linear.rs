//! Homogeneous linear equations with noise, and coordinates in which they are well scaled.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::least_squares::right_singular;

/// A second singular value that is smaller beside the largest is rounding: then there are several
/// null vectors.
const UNDECIDED: f64 = 1e-9;

// ANCHOR: null_vector
/// The unit vector that makes a matrix of rows the smallest; `None` when another one does as well, or
/// when the rows are not finite.
pub(crate) fn least_vector(rows: DMatrix<f64>) -> Option<DVector<f64>> {
    if !rows.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let (values, vectors) = right_singular(rows);
    (values[1] > UNDECIDED * values[values.len() - 1]).then(|| vectors.column(0).into_owned())
}
// ANCHOR_END: null_vector

// ANCHOR: hartley
/// The matrix that takes rays to where their slopes have mean zero and a mean square of two
/// [@hartley1997eight]; `None` when all are the same.
pub(super) fn normalization<'a>(
    rays: impl ExactSizeIterator<Item = &'a Vector3<f64>> + Clone,
) -> Option<Matrix3<f64>> {
    let count = rays.len() as f64;
    let slopes = rays.map(|ray| ray.xy() / ray.z);
    let mean = slopes.clone().sum::<nalgebra::Vector2<f64>>() / count;
    let square: f64 = slopes.map(|slope| (slope - mean).norm_squared()).sum();
    let scale = (2.0 * count / square).sqrt();
    let [x, y] = [-scale * mean.x, -scale * mean.y];
    scale.is_finite().then(|| Matrix3::new(scale, 0.0, x, 0.0, scale, y, 0.0, 0.0, 1.0))
}
// ANCHOR_END: hartley
