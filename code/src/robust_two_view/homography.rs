//! The homography of a plane, and the motions that it stands for.

use nalgebra::{DMatrix, Matrix3, Rotation3, Unit, Vector3};
use thiserror::Error;

use super::linear::{least_vector, normalization};
use super::motion::frame;
use super::{Candidates, RayPair, RelativeMotion, matches_are_finite};

/// Three rays that span less lie in one plane, up to rounding.
const FLAT: f64 = 1e-10;

// ANCHOR: homography_of_four
/// The matrix that takes four rays to four others, up to their lengths and up to scale.
///
/// Four rays are to space what a basis with a scale for each axis is: the matrix goes from the first
/// picture's to the coordinates in which they are the three axes and their sum, and from there to
/// the second's.
///
/// # Errors
///
/// [`HomographyError`] when three points lie on a line, or a ray is zero or not finite.
pub fn homography_of_four(pairs: &[RayPair; 4]) -> Result<Matrix3<f64>, HomographyError> {
    let is_ray = |ray: &Vector3<f64>| ray.norm() > 0.0 && ray.norm().is_finite();
    if let Some(pair) = pairs.iter().position(|(first, second)| !(is_ray(first) && is_ray(second)))
    {
        return Err(HomographyError::Ray { pair });
    }
    let first = scaled_basis(&pairs.map(|pair| pair.0))?;
    let second = scaled_basis(&pairs.map(|pair| pair.1))?;
    let inverse = first.try_inverse().ok_or(HomographyError::Collinear)?;
    facing(&(second * inverse), pairs)
}

/// The matrix whose columns are three of the rays, so long that their sum is the fourth.
fn scaled_basis(rays: &[Vector3<f64>; 4]) -> Result<Matrix3<f64>, HomographyError> {
    let [a, b, c, sum] = rays.map(|ray| ray.normalize());
    let volumes = [b.cross(&c).dot(&sum), c.cross(&a).dot(&sum), a.cross(&b).dot(&sum)];
    let is_flat = |volume: f64| volume.is_nan() || volume.abs() <= FLAT;
    if volumes.into_iter().any(is_flat) || is_flat(a.cross(&b).dot(&c)) {
        return Err(HomographyError::Collinear);
    }
    let whole = a.cross(&b).dot(&c);
    let [x, y, z] = volumes.map(|volume| volume / whole);
    Ok(Matrix3::from_columns(&[x * a, y * b, z * c]))
}
// ANCHOR_END: homography_of_four

// ANCHOR: homography_of_many
/// The matrix that takes four rays or more nearly to others, in coordinates with mean zero and a mean
/// square of two: the direct linear transform [@hartley2004]. The rays point forward. With noise it is
/// a start.
///
/// # Errors
///
/// [`HomographyError`] when there are too few, a ray is not finite or does not point forward, or there
/// are no four of which no three lie on a line.
pub fn homography_of_many(pairs: &[RayPair]) -> Result<Matrix3<f64>, HomographyError> {
    if pairs.len() < 4 {
        return Err(HomographyError::TooFew { count: pairs.len() });
    }
    matches_are_finite(pairs).map_err(|pair| HomographyError::Ray { pair })?;
    let first =
        normalization(pairs.iter().map(|pair| &pair.0)).ok_or(HomographyError::Collinear)?;
    let second =
        normalization(pairs.iter().map(|pair| &pair.1)).ok_or(HomographyError::Collinear)?;
    // Fewer rows than columns would leave a null vector for nothing.
    let mut rows = DMatrix::zeros((2 * pairs.len()).max(9), 9);
    for (k, (a, b)) in pairs.iter().enumerate() {
        let (a, b) = (first * a / a.z, second * b / b.z);
        for axis in 0..2 {
            for (column, entry) in a.iter().enumerate() {
                rows[(2 * k + axis, 3 * axis + column)] = *entry;
                rows[(2 * k + axis, 6 + column)] = -b[axis] / b.z * entry;
            }
        }
    }
    let entries = least_vector(rows).ok_or(HomographyError::Collinear)?;
    let back = second.try_inverse().ok_or(HomographyError::Collinear)?;
    facing(&(back * Matrix3::from_row_slice(entries.as_slice()) * first), pairs)
}
// ANCHOR_END: homography_of_many

/// The matrix with a length of one and the sign with which the rays keep to their sides.
fn facing(matrix: &Matrix3<f64>, pairs: &[RayPair]) -> Result<Matrix3<f64>, HomographyError> {
    let kept = |(first, second): &&RayPair| (matrix * first).dot(second) > 0.0;
    let sign = if 2 * pairs.iter().filter(kept).count() >= pairs.len() { 1.0 } else { -1.0 };
    let matrix = matrix * (sign / matrix.norm());
    let is_finite = matrix.iter().all(|entry| entry.is_finite());
    is_finite.then_some(matrix).ok_or(HomographyError::Collinear)
}

// ANCHOR: plane_motion
/// A motion and the plane that it is seen by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneMotion {
    /// How the second camera stands to the first.
    pub motion: RelativeMotion,
    /// The normal of the plane in the first camera, pointing away from it.
    pub normal: Unit<Vector3<f64>>,
    /// The baseline over the distance of the plane from the first camera.
    pub baseline: f64,
}
// ANCHOR_END: plane_motion

/// Squared singular values that differ by less from one are one: the camera only turned.
const TURNED: f64 = 1e-12;

/// Of so many rays one may lie beyond the horizon of the plane.
const ACCIDENTS: usize = 20;

// ANCHOR: plane_motions
/// The motions and planes, at most two, whose homography R + s t nᵀ {eq:plane-homography} a matrix is,
/// up to scale, with the rays of the first camera meeting the plane in front of it [@ma2004]. One ray in
/// twenty may not: it belongs to a wrong match that agrees by accident.
///
/// With the scale that makes its second singular value one, R + s t nᵀ changes no length in the plane
/// that is orthogonal to n. Two planes of directions keep their lengths: those spanned by the middle
/// right singular vector and one of two mixtures of the others.
///
/// # Errors
///
/// [`HomographyError::Turned`] when the matrix is a rotation, which every plane explains, and
/// [`HomographyError::Collinear`] when it has rank one or is not finite.
pub fn plane_motions(
    homography: &Matrix3<f64>,
    rays: &[Vector3<f64>],
) -> Result<Candidates<PlaneMotion, 2>, HomographyError> {
    let gram = (homography.transpose() * homography).symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| gram.eigenvalues[*b].total_cmp(&gram.eigenvalues[*a]));
    let middle = gram.eigenvalues[order[1]];
    let [most, _, least] = order.map(|k| gram.eigenvalues[k] / middle);
    if !(most.is_finite() && least.is_finite()) {
        return Err(HomographyError::Collinear);
    }
    if most - least <= TURNED {
        return Err(HomographyError::Turned);
    }
    let [v, w, u] =
        [order[0], order[1], order[2]].map(|k| gram.eigenvectors.column(k).into_owned());
    let matrix = homography * (homography.determinant().signum() / middle.sqrt());
    let [along, across] = [(1.0 - least).max(0.0).sqrt(), (most - 1.0).max(0.0).sqrt()];
    let filler = RelativeMotion { rotation: Rotation3::identity(), direction: Vector3::x_axis() };
    let filler = PlaneMotion { motion: filler, normal: Vector3::z_axis(), baseline: 0.0 };
    let mut found = Candidates::none(filler);
    // After a step along the normal the two mixtures are one.
    let mixtures: &[f64] = if along.min(across).powi(2) <= TURNED { &[1.0] } else { &[1.0, -1.0] };
    for sign in mixtures {
        let kept = (along * v + sign * across * u) / (most - least).sqrt();
        if let Some(motion) = keeping(&matrix, &w, &kept, rays) {
            found.push(motion);
        }
    }
    Ok(found)
}

/// The motion of a homography that changes no length in the plane of two unit vectors.
fn keeping(
    matrix: &Matrix3<f64>,
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    rays: &[Vector3<f64>],
) -> Option<PlaneMotion> {
    let normal = a.cross(b);
    let before = Matrix3::from_columns(&[*a, *b, normal]);
    let after = frame(&(matrix * a), &(matrix * b));
    let rotation = Rotation3::from_matrix_unchecked(after * before.transpose());
    let shift = (matrix - rotation.matrix()) * normal;
    let ahead = rays.iter().filter(|ray| normal.dot(ray) > 0.0).count();
    let behind = rays.len() - ahead;
    let sign = if ahead >= behind { 1.0 } else { -1.0 };
    let in_front = ACCIDENTS * ahead.min(behind) <= rays.len();
    let direction = Unit::try_new(sign * shift, 0.0)?;
    let normal = Unit::new_unchecked(sign * normal);
    let motion = RelativeMotion { rotation, direction };
    in_front.then(|| PlaneMotion { motion, normal, baseline: shift.norm() })
}
// ANCHOR_END: plane_motions

/// Why there is no homography, or no motion in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum HomographyError {
    /// There are fewer than four.
    #[error("there are {count} points; give four or more")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// A ray is not finite or does not point forward.
    #[error("pair {pair}: a ray is zero, not finite or does not point forward; leave the pair out")]
    Ray {
        /// Which pair.
        pair: usize,
    },
    /// There are no four points in general position.
    #[error("too many of the points lie on one line; give four of which no three do")]
    Collinear,
    /// There is no baseline in it.
    #[error("the homography is a rotation; a camera that only turned shows no plane")]
    Turned,
}
