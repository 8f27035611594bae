//! The pose of a camera from many points.

use nalgebra::{DMatrix, Isometry3, Matrix3, Matrix6, Vector2, Vector3};
use thiserror::Error;

use crate::bearing::back_project;
use crate::bundle_adjustment::{Posed, PosedPinhole};
use crate::factors::{MovingCamera, PixelByCamera};
use crate::filtering::rotation_towards;
use crate::least_squares::{Kernel, Key, Options, Problem, SolveError};
use crate::reprojection::Pinhole;
use crate::robust_two_view::least_vector;

/// The unknowns of the linear method, and what each point says of them.
const ENTRIES: usize = 12;
/// What less decides between two rotations is rounding.
const UNDECIDED: f64 = 1e-9;

// ANCHOR: linear_pose
/// The pose `camera_from_world` from six points or more, by the direct linear transform
/// [@hartley2004]: exact for pixels without noise, and with noise a start for [`resect`].
///
/// # Errors
///
/// [`ResectionError`], among others for points that are all, or all but one, in a plane: they leave the
/// twelve entries of the linear method open, or have it find a matrix that is no rotation.
pub fn linear_pose(
    camera: &Pinhole,
    points: &[Vector3<f64>],
    pixels: &[Vector2<f64>],
) -> Result<Isometry3<f64>, ResectionError> {
    check(points, pixels, 6)?;
    let count = points.len() as f64;
    let centre = points.iter().sum::<Vector3<f64>>() / count;
    let square: f64 = points.iter().map(|point| (point - centre).norm_squared()).sum();
    let size = (square / count).sqrt();
    let mut rows = DMatrix::zeros((2 * points.len()).max(ENTRIES), ENTRIES);
    for (k, (point, pixel)) in points.iter().zip(pixels).enumerate() {
        let (point, slopes) =
            (((point - centre) / size).push(1.0), back_project(camera, pixel, 1.0));
        for axis in 0..2 {
            let mut row = rows.row_mut(2 * k + axis);
            row.columns_mut(4 * axis, 4).copy_from(&point.transpose());
            row.columns_mut(8, 4).copy_from(&(-slopes[axis] * point.transpose()));
        }
    }
    let entries = least_vector(rows).ok_or(ResectionError::Degenerate)?;
    let row = |at: usize| entries.fixed_rows::<3>(4 * at).transpose();
    let matrix = Matrix3::from_rows(&[row(0), row(1), row(2)]);
    let shift = Vector3::new(entries[3], entries[7], entries[11]);
    let scale = matrix.determinant().cbrt();
    let turn = matrix.unscale(scale.signum() * matrix.norm());
    let rotation = rotation_towards(&turn, UNDECIDED).ok_or(ResectionError::Degenerate)?;
    let translation = shift * (size / scale) - rotation * centre;
    Ok(Isometry3::from_parts(translation.into(), rotation.into()))
}
// ANCHOR_END: linear_pose

// ANCHOR: resected
/// A camera's pose and what is known about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resected {
    /// The most likely pose.
    pub camera_from_world: Isometry3<f64>,
    /// The covariance of the twist, translation first, that moves the pose on the right.
    pub covariance: Matrix6<f64>,
    /// Half the sum of squared whitened residuals.
    pub cost: f64,
}

/// Resection: the pose at which the pixels of points that are known are most likely, from `start`,
/// when each coordinate was measured with a standard deviation of `sigma` pixels.
///
/// # Errors
///
/// [`ResectionError`] when there are fewer than three points, a point lies behind the camera at the
/// start, or the points leave the pose open.
// ANCHOR: resect
pub fn resect(
    camera: &Pinhole,
    points: &[Vector3<f64>],
    pixels: &[Vector2<f64>],
    sigma: f64,
    start: &Isometry3<f64>,
) -> Result<Resected, ResectionError> {
    check(points, pixels, 3)?;
    if !(sigma > 0.0 && sigma.is_finite()) {
        return Err(ResectionError::Sigma { sigma });
    }
    let data = points.iter().copied().zip(pixels.iter().copied());
    let (problem, pose) = of_points(camera, data, sigma, start);
    let solution = problem.solve(&Options::default())?.settled()?;
    let covariance = problem.covariance(&solution.values)?.of(pose);
    let covariance = covariance.ok_or(ResectionError::Degenerate)?;
    Ok(Resected {
        camera_from_world: solution.values[pose].0.camera_from_world,
        covariance: Matrix6::from_column_slice(covariance.as_slice()),
        cost: solution.report.cost,
    })
}
// ANCHOR_END: resect
// ANCHOR_END: resected

/// A camera that moves and landmarks that are held.
pub(super) fn of_points(
    camera: &Pinhole,
    data: impl Iterator<Item = (Vector3<f64>, Vector2<f64>)>,
    sigma: f64,
    start: &Isometry3<f64>,
) -> (Problem, Key<MovingCamera<PosedPinhole, 6>>) {
    let mut problem = Problem::new();
    let posed = Posed { intrinsics: *camera, camera_from_world: *start };
    let pose = problem.add_variable(MovingCamera(posed));
    for (point, pixel) in data {
        let landmark = problem.add_variable(point);
        let factor = PixelByCamera { camera: pose, landmark, pixel, inverse_sigma: 1.0 / sigma };
        let added =
            problem.hold(landmark).and_then(|()| problem.add_factor(factor, Kernel::Squared));
        added.expect("the variables are the problem's own");
    }
    (problem, pose)
}

/// That points and pixels belong together and are numbers.
fn check(
    points: &[Vector3<f64>],
    pixels: &[Vector2<f64>],
    needed: usize,
) -> Result<(), ResectionError> {
    let (count, seen) = (points.len(), pixels.len());
    if count != seen {
        return Err(ResectionError::Lengths { points: count, pixels: seen });
    }
    if count < needed {
        return Err(ResectionError::TooFew { count, needed });
    }
    let both = points.iter().zip(pixels);
    let is_finite = |(point, pixel): (&Vector3<f64>, &Vector2<f64>)| {
        point.iter().chain(pixel.iter()).all(|entry| entry.is_finite())
    };
    match both.into_iter().position(|datum| !is_finite(datum)) {
        Some(point) => Err(ResectionError::NotFinite { point }),
        None => Ok(()),
    }
}

/// Why there is no pose.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ResectionError {
    /// Not every point has a pixel.
    #[error("there are {points} points and {pixels} pixels; give one pixel for each point")]
    Lengths {
        /// How many points.
        points: usize,
        /// How many pixels.
        pixels: usize,
    },
    /// There are too few.
    #[error("there are {count} points; give {needed} or more")]
    TooFew {
        /// How many there are.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A number is NaN or infinite.
    #[error("point {point}: its place or pixel is not finite; leave it out")]
    NotFinite {
        /// Which point.
        point: usize,
    },
    /// The standard deviation is none.
    #[error("sigma is {sigma}; give a positive, finite number of pixels")]
    Sigma {
        /// What was given, in pixels.
        sigma: f64,
    },
    /// The linear method has more than one solution.
    #[error(
        "the linear method leaves the pose open: the points lie in one plane or on a critical curve; \
         begin with three points instead"
    )]
    Degenerate,
    /// The refinement has no minimum, or none that is fixed.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
