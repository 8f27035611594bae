//! The similarity between two worlds from points that are known in both.

use nalgebra::{Matrix3, Vector3};
use thiserror::Error;

use crate::filtering::rotation_towards;
use crate::observability::Similarity;

/// Points whose spread is a smaller part of their coordinates, squared, are in one place.
const ONE_PLACE: f64 = 1e-12;
/// A rotation is open when the next stationary one, half a turn away, makes the sum that it maximizes
/// smaller by less than this part of the spread.
const UNDECIDED: f64 = 1e-9;

/// Whether the two worlds have one unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScaleFreedom {
    /// They need not have.
    Free,
    /// They have: the scale is one.
    One,
}

// ANCHOR: absolute_orientation
/// The similarity that takes the first of each pair of points to the second with the least sum of
/// squares of what is left, in closed form [@horn1987; @umeyama1991].
///
/// The translation takes mean to mean. The rotation R makes the sum of bᵀ R a largest, over the points
/// less their means, whatever the scale is; and the best scale is that sum over the sum of aᵀ a.
/// The rotation is found as a quaternion, so that it is never a reflection.
///
/// # Errors
///
/// [`OrientationError`] names what leaves the rotation or the scale open.
pub fn absolute_orientation(
    pairs: &[(Vector3<f64>, Vector3<f64>)],
    scale: ScaleFreedom,
) -> Result<Similarity, OrientationError> {
    check(pairs)?;
    let count = pairs.len() as f64;
    let (a, b) = pairs.iter().fold((Vector3::zeros(), Vector3::zeros()), |(a, b), pair| {
        (a + pair.0 / count, b + pair.1 / count)
    });
    // ANCHOR: closed_form
    let centred = || pairs.iter().map(|pair| (pair.0 - a, pair.1 - b));
    let squares = centred().fold((0.0, 0.0), |(one, other): (f64, f64), (a, b)| {
        (one + a.norm_squared(), other + b.norm_squared())
    });
    let moment: Matrix3<f64> = centred().map(|(a, b)| b * a.transpose()).sum();
    let reach = pairs.iter().map(|pair| pair.0.amax() * pair.1.amax()).fold(0.0, f64::max);
    let extent = (squares.0 * squares.1).sqrt();
    if extent <= ONE_PLACE * reach {
        return Err(OrientationError::OnePlace);
    }
    let rotation =
        rotation_towards(&moment, UNDECIDED * extent).ok_or(OrientationError::Rotation)?;
    let along = rotation.matrix().component_mul(&moment).sum();
    let scale = match scale {
        ScaleFreedom::Free => along / squares.0,
        ScaleFreedom::One => 1.0,
    };
    // ANCHOR_END: closed_form
    Ok(Similarity { scale, rotation, translation: b - scale * (rotation * a) })
}
// ANCHOR_END: absolute_orientation

/// That there are enough pairs, and that they are numbers.
fn check(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> Result<(), OrientationError> {
    if pairs.len() < 3 {
        return Err(OrientationError::TooFew { count: pairs.len() });
    }
    let is_finite = |point: &Vector3<f64>| point.iter().all(|entry| entry.is_finite());
    match pairs.iter().position(|pair| !(is_finite(&pair.0) && is_finite(&pair.1))) {
        Some(pair) => Err(OrientationError::NotFinite { pair }),
        None => Ok(()),
    }
}

/// Why there is no similarity.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum OrientationError {
    /// There are fewer than three.
    #[error("there are {count} pairs of points; give three or more")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// A number is NaN or infinite.
    #[error("pair {pair} has a coordinate that is not finite; leave it out")]
    NotFinite {
        /// The first of them.
        pair: usize,
    },
    /// All points of a world are the same.
    #[error("all points of one world lie in one place; give points that are apart")]
    OnePlace,
    /// Another rotation does as well.
    #[error(
        "more than one rotation fits: the points of one world lie on a line, or the two resemble each \
         other's mirror image; give points beside the line"
    )]
    Rotation,
}
