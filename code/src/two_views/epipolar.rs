//! What two pictures of one scene have to do with each other before any point is known.

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3};
use thiserror::Error;

use crate::manifold::so3;
use crate::reprojection::Pinhole;

// ANCHOR: essential
/// The essential matrix of two cameras [@longuethiggins1981], in metres: its length is that of the
/// baseline.
///
/// Implements the E of {eq:coplanarity}.
pub fn essential_matrix(second_from_first: &Isometry3<f64>) -> Matrix3<f64> {
    let rotation = second_from_first.rotation.to_rotation_matrix().into_inner();
    so3::hat(&second_from_first.translation.vector) * rotation
}

/// How far two directions, each in its own camera, are from lying in one plane with the
/// baseline: zero for two pictures of one point.
///
/// Directions may have any length. For unit directions and a baseline of one metre it is
/// the volume that the three of them span. Implements {eq:coplanarity}.
pub fn epipolar_residual(
    essential: &Matrix3<f64>,
    first_direction: &Vector3<f64>,
    second_direction: &Vector3<f64>,
) -> f64 {
    second_direction.dot(&(essential * first_direction))
}
// ANCHOR_END: essential

// ANCHOR: epipolar_line
/// The matrix that compares pixels as the essential matrix compares directions.
pub fn fundamental_matrix(
    first_camera: &Pinhole,
    second_camera: &Pinhole,
    essential: &Matrix3<f64>,
) -> Matrix3<f64> {
    slopes(second_camera).transpose() * essential * slopes(first_camera)
}

/// The line (a, b, c) of the second image on which a pixel of the first must lie, or `None`
/// when there is no line: the pixel is the epipole, or the cameras have one centre.
///
/// The line is scaled so that a u + b v + c is the distance of the pixel (u, v) from it, in
/// pixels. Implements {eq:epipolar-line}.
pub fn epipolar_line(
    fundamental: &Matrix3<f64>,
    first_pixel: &Vector2<f64>,
) -> Option<Vector3<f64>> {
    let line = fundamental * first_pixel.push(1.0);
    let length = line.xy().norm();
    (length > 0.0 && length.is_finite()).then(|| line / length)
}
// ANCHOR_END: epipolar_line

/// The inverse of K, which takes a pixel with a one below it to the slopes of its ray.
fn slopes(camera: &Pinhole) -> Matrix3<f64> {
    let (fx, fy) = (camera.fx, camera.fy);
    Matrix3::new(1.0 / fx, 0.0, -camera.cx / fx, 0.0, 1.0 / fy, -camera.cy / fy, 0.0, 0.0, 1.0)
}

// ANCHOR: sampson
/// The Sampson distance [@hartley2004]: by how many pixels two measured pixels, taken together,
/// miss being pictures of one point, to first order, or `None` where no pair of lines says so.
///
/// Its square is the least sum of squared moves of both pixels that satisfies
/// {eq:coplanarity}. It has the sign of the residual: compare its size. Implements {eq:sampson}.
pub fn sampson_distance(
    fundamental: &Matrix3<f64>,
    first_pixel: &Vector2<f64>,
    second_pixel: &Vector2<f64>,
) -> Option<f64> {
    let line_in_second = fundamental * first_pixel.push(1.0);
    let line_in_first = fundamental.transpose() * second_pixel.push(1.0);
    let slope = line_in_second.xy().norm().hypot(line_in_first.xy().norm());
    let residual = second_pixel.push(1.0).dot(&line_in_second);
    (slope > 0.0 && slope.is_finite()).then(|| residual / slope)
}
// ANCHOR_END: sampson

// ANCHOR: relative_poses
/// The decomposition of an essential matrix: the four motions `second_from_first` that have it
/// [@hartley2004], with a baseline of one, since the scale is not in it. Only one of them puts
/// the scene in front of both cameras.
///
/// A matrix that is only nearly essential, as estimates are, is first replaced by the
/// nearest one that is. Implements {eq:essential-poses}.
///
/// # Errors
///
/// [`EssentialError`] when there is no direction of motion in the matrix.
pub fn relative_poses(essential: &Matrix3<f64>) -> Result<[Isometry3<f64>; 4], EssentialError> {
    let nearest = nearest_essential(essential)?;
    let translation = left_null_vector(&nearest);
    let pose = |sign: f64, direction: f64| {
        let translation = direction * translation;
        let rotation = cofactors(&nearest) - sign * so3::hat(&translation) * nearest;
        let rotation = Rotation3::from_matrix_unchecked(rotation);
        Isometry3::from_parts(translation.into(), rotation.into())
    };
    // A sign of +1 solves for the matrix as given, a sign of -1 for its negative.
    Ok([pose(1.0, 1.0), pose(1.0, -1.0), pose(-1.0, 1.0), pose(-1.0, -1.0)])
}
// ANCHOR_END: relative_poses

/// The nearest matrix with singular values 1, 1 and 0, up to scale.
fn nearest_essential(essential: &Matrix3<f64>) -> Result<Matrix3<f64>, EssentialError> {
    if !essential.iter().all(|entry| entry.is_finite()) {
        return Err(EssentialError::NotFinite);
    }
    let largest = essential.amax();
    if largest == 0.0 {
        return Err(EssentialError::Zero);
    }
    let svd = (essential / largest).svd(true, true);
    let values = svd.singular_values;
    let (Some(u), Some(v_transposed)) = (svd.u, svd.v_t) else {
        return Err(EssentialError::NotFinite);
    };
    if values[1] <= 1e-9 * values[0] {
        return Err(EssentialError::RankOne { ratio: values[1] / values[0] });
    }
    Ok(u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * v_transposed)
}

/// The matrix of cofactors: its columns are the cross products of the other two. Of a symmetric matrix it
/// is the adjugate.
pub(crate) fn cofactors(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c] = [0, 1, 2].map(|column| matrix.column(column).into_owned());
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

/// The unit vector orthogonal to all columns of a matrix of rank two: the longest of their
/// cross products, so that nothing small is divided by.
fn left_null_vector(matrix: &Matrix3<f64>) -> Vector3<f64> {
    let products = cofactors(matrix);
    products.column(products.map(f64::abs).row_sum().transpose().imax()).normalize()
}

// ANCHOR: ray_depths
/// How far along each of two directions, in multiples of their own lengths, the rays come
/// nearest to each other, in metres of the baseline. They are infinite or NaN when the rays
/// are parallel, and a negative one lies behind its camera.
pub fn ray_depths(
    second_from_first: &Isometry3<f64>,
    first_direction: &Vector3<f64>,
    second_direction: &Vector3<f64>,
) -> (f64, f64) {
    let turned = second_from_first.rotation * first_direction;
    let baseline = &second_from_first.translation.vector;
    let normal = turned.cross(second_direction);
    let squared = normal.norm_squared();
    let first = normal.dot(&second_direction.cross(baseline)) / squared;
    let second = normal.dot(&turned.cross(baseline)) / squared;
    (first, second)
}
// ANCHOR_END: ray_depths

// ANCHOR: relative_pose
/// The one of [`relative_poses`] that puts the most points in front of both cameras, which is the
/// test of cheirality [@hartley2004], and how many those are. Each pair holds the directions of
/// one point in the first and the second.
///
/// # Errors
///
/// Those of [`relative_poses`], and [`EssentialError`] when two motions put equally many points in front,
/// or none does any.
pub fn relative_pose(
    essential: &Matrix3<f64>,
    pairs: &[(Vector3<f64>, Vector3<f64>)],
) -> Result<(Isometry3<f64>, usize), EssentialError> {
    let poses = relative_poses(essential)?;
    let in_front = poses.map(|pose| {
        let depths = pairs.iter().map(|(first, second)| ray_depths(&pose, first, second));
        depths.filter(|(first, second)| *first > 0.0 && *second > 0.0).count()
    });
    let most = in_front.into_iter().max().unwrap_or(0);
    let mut winners = (0..4).filter(|pose| in_front[*pose] == most);
    match (winners.next(), winners.next()) {
        (Some(winner), None) => Ok((poses[winner], most)),
        _ => Err(EssentialError::Ambiguous { in_front }),
    }
}
// ANCHOR_END: relative_pose

/// Why a matrix gives no relative pose.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum EssentialError {
    /// An entry is not finite.
    #[error("the matrix has an entry that is not finite; estimate it from finite pixels")]
    NotFinite,
    /// All entries are zero, as for cameras with one centre.
    #[error("the essential matrix is zero: the camera only turned; wait until it has moved")]
    Zero,
    /// The second singular value is nothing beside the first, where they should be equal.
    #[error(
        "the second singular value is {ratio:.1e} of the first, where an essential matrix has \
         them equal; estimate it from more points"
    )]
    RankOne {
        /// Second singular value over the first.
        ratio: f64,
    },
    /// More than one motion explains the points equally well.
    #[error(
        "the four motions put {in_front:?} points in front of both cameras, and no single one \
         the most; give more correct pairs"
    )]
    Ambiguous {
        /// For each motion, how many points lie in front of both cameras.
        in_front: [usize; 4],
    },
}
