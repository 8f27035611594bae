//! A point from two or more views whose poses are known.

use nalgebra::{Isometry3, Matrix2x4, Matrix4, Matrix6x4, SMatrix, Vector2, Vector3};
use thiserror::Error;

use crate::bearing::{back_project, parallax};
use crate::bundle_adjustment::PosedPinhole;
use crate::manifold::se3;
use crate::reprojection::{Pinhole, Z_MIN};

// ANCHOR: view
/// A camera whose pose is known, and the pixel at which it saw the point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The intrinsics.
    pub camera: Pinhole,
    /// Takes world coordinates to camera coordinates.
    pub camera_from_world: Isometry3<f64>,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// Standard deviation of each of its coordinates, in pixels.
    pub sigma: f64,
}

/// An angle between rays, in radians, that is worth triangulating: one degree.
pub const LEAST_PARALLAX: f64 = std::f64::consts::PI / 180.0;
// ANCHOR_END: view

/// One over the distance, in lengths of the baseline, from which rounding puts a point.
const AT_INFINITY: f64 = 1e-13;

impl View {
    /// A view that reports a direction in camera coordinates instead of a pixel. Its camera
    /// has a focal length of one, so its "pixels" are slopes and `sigma` is an angle in
    /// radians near the axis.
    ///
    /// # Errors
    ///
    /// [`TriangulationError::Direction`] when the direction does not point forward.
    pub fn of_direction(
        camera_from_world: Isometry3<f64>,
        direction: &Vector3<f64>,
        sigma: f64,
    ) -> Result<Self, TriangulationError> {
        let pixel = direction.xy() / direction.z;
        if !(direction.z > 0.0 && pixel.x.is_finite() && pixel.y.is_finite()) {
            return Err(TriangulationError::Direction { z: direction.z });
        }
        let camera = Pinhole { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 };
        Ok(Self { camera, camera_from_world, pixel, sigma })
    }

    /// The camera's centre in the world, in metres.
    pub fn centre(&self) -> Vector3<f64> {
        let pose = &self.camera_from_world;
        -pose.rotation.inverse_transform_vector(&pose.translation.vector)
    }

    /// The direction of the pixel in the world, with a length of at least one.
    pub fn ray(&self) -> Vector3<f64> {
        let direction = back_project(&self.camera, &self.pixel, 1.0);
        self.camera_from_world.rotation.inverse_transform_vector(&direction)
    }

    /// The camera at its pose.
    pub(super) fn posed(&self) -> PosedPinhole {
        PosedPinhole { intrinsics: self.camera, camera_from_world: self.camera_from_world }
    }

    /// Coordinates of a point of the world in the camera, in metres.
    pub(super) fn in_camera(&self, point: &Vector3<f64>) -> Vector3<f64> {
        se3::transform(&self.camera_from_world, point)
    }
}

// ANCHOR: triangulate
/// The point in the world that the views see, by the linear method, when it lies in front of
/// all of them and two of their rays meet at an angle of `least_parallax` or more.
///
/// The direct linear transform of @hartley2004: exact for pixels without noise, and with noise
/// a start for [`triangulate_nonlinear`](super::triangulate_nonlinear).
/// Implements {eq:dlt-rows}.
///
/// # Errors
///
/// [`TriangulationError`] names what is missing, and by how much.
pub fn triangulate(
    views: &[View],
    least_parallax: f64,
) -> Result<Vector3<f64>, TriangulationError> {
    check(views)?;
    let world = Normalization::of(views)?;
    let angle = widest_parallax(views);
    if angle.is_nan() || angle < least_parallax {
        return Err(TriangulationError::Parallax { angle, least: least_parallax });
    }
    let point = linear_point(views, &world).ok_or(TriangulationError::AtInfinity { angle })?;
    refuse_behind(views, &point)?;
    Ok(point)
}
// ANCHOR_END: triangulate

// ANCHOR: linear_point
/// The point (X, Y, Z, W), up to scale, that makes all rows as small as they can be together;
/// `None` when it lies at infinity.
///
/// The rows are reduced to a 4×4 triangle view by view. Their products would be fewer
/// numbers, but squares of small angles.
fn linear_point(views: &[View], world: &Normalization) -> Option<Vector3<f64>> {
    let sharpest = views.iter().map(|view| view.sigma).fold(f64::INFINITY, f64::min);
    let mut triangle = Matrix4::zeros();
    for view in views {
        let mut stacked = Matrix6x4::zeros();
        stacked.fixed_rows_mut::<4>(0).copy_from(&triangle);
        stacked.fixed_rows_mut::<2>(4).copy_from(&linear_rows(view, world, sharpest));
        triangle = stacked.qr().r();
    }
    if !is_finite(&triangle) {
        return None;
    }
    let right_vectors = triangle.try_svd(false, true, f64::EPSILON, 200)?.v_t?;
    let homogeneous = right_vectors.row(3).transpose();
    let point = world.centre + world.length * homogeneous.xyz() / homogeneous.w;
    (homogeneous.w.abs() > AT_INFINITY && is_finite(&point)).then_some(point)
}
// ANCHOR_END: linear_point

// ANCHOR: linear_rows
/// The two rows that one view gives: the pixel's slopes times the depth, less the lateral
/// coordinates. They are divided by the noise of a slope, in that of the sharpest view's pixels, so that
/// sharper views count more.
fn linear_rows(view: &View, world: &Normalization, sharpest: f64) -> Matrix2x4<f64> {
    let rotation = view.camera_from_world.rotation.to_rotation_matrix();
    let mut coordinates = rotation.matrix().insert_column(3, 0.0);
    coordinates.set_column(3, &(view.in_camera(&world.centre) / world.length));
    let slope = back_project(&view.camera, &view.pixel, 1.0);
    let row = |axis: usize, focal_length: f64| {
        let weight = focal_length * (sharpest / view.sigma);
        (slope[axis] * coordinates.row(2) - coordinates.row(axis)) * weight
    };
    Matrix2x4::from_rows(&[row(0, view.camera.fx), row(1, view.camera.fy)])
}
// ANCHOR_END: linear_rows

/// That no view has the point behind it, or nearer than a camera can see.
pub(super) fn refuse_behind(
    views: &[View],
    point: &Vector3<f64>,
) -> Result<(), TriangulationError> {
    for (view, seen) in views.iter().enumerate() {
        let depth = seen.in_camera(point).z;
        if depth.is_nan() || depth <= Z_MIN {
            return Err(TriangulationError::Behind { view, depth });
        }
    }
    Ok(())
}

// ANCHOR: normalization
/// A world in which the cameras lie around the origin at a distance of about one, so that
/// neither the place of the origin nor the unit of length has a say in the result.
struct Normalization {
    centre: Vector3<f64>,
    /// Root of the mean squared distance of the cameras from their mean, in metres.
    length: f64,
}

impl Normalization {
    fn of(views: &[View]) -> Result<Self, TriangulationError> {
        let count = views.len() as f64;
        let centre = views.iter().map(View::centre).sum::<Vector3<f64>>() / count;
        let squares: f64 = views.iter().map(|view| (view.centre() - centre).norm_squared()).sum();
        let length = (squares / count).sqrt();
        let farthest = views.iter().map(|view| view.centre().norm()).fold(0.0, f64::max);
        // Centres that differ by less than rounding are one centre.
        if length <= 1e-12 * farthest || length == 0.0 {
            return Err(TriangulationError::NoBaseline { length });
        }
        Ok(Self { centre, length })
    }
}
// ANCHOR_END: normalization

// ANCHOR: widest_parallax
/// The largest angle, in radians, between the rays of any two views.
pub(crate) fn widest_parallax(views: &[View]) -> f64 {
    let mut widest = 0.0;
    for (index, view) in views.iter().enumerate() {
        for other in &views[..index] {
            // Seen from the origin, the two directions are points.
            let angle = parallax(&Vector3::zeros(), &view.ray(), &other.ray());
            widest = f64::max(widest, angle);
        }
    }
    widest
}
// ANCHOR_END: widest_parallax

/// Whether all entries are; the routines below would not return from one that is not.
pub(super) fn is_finite<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> bool {
    matrix.iter().all(|entry| entry.is_finite())
}

/// That there are views and that their numbers are numbers.
pub(super) fn check(views: &[View]) -> Result<(), TriangulationError> {
    if views.len() < 2 {
        return Err(TriangulationError::TooFewViews { count: views.len() });
    }
    for (index, view) in views.iter().enumerate() {
        let (u, v) = (view.pixel.x, view.pixel.y);
        if !(u.is_finite() && v.is_finite()) {
            return Err(TriangulationError::Pixel { view: index, u, v });
        }
        if !(view.sigma > 0.0 && view.sigma.is_finite() && view.sigma.recip().is_finite()) {
            return Err(TriangulationError::Sigma { view: index, sigma: view.sigma });
        }
        let Pinhole { fx, fy, cx, cy } = view.camera;
        let is_camera = Pinhole::new(fx, fy, cx, cy).is_ok();
        let is_pose = is_finite(&view.camera_from_world.to_homogeneous());
        if !(is_camera && is_pose) {
            return Err(TriangulationError::Camera { view: index });
        }
    }
    Ok(())
}

/// Why there is no point.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TriangulationError {
    /// A single view has no depth, and none at all has nothing.
    #[error("{count} views were given; a point needs two or more")]
    TooFewViews {
        /// How many were given.
        count: usize,
    },
    /// A coordinate of a pixel is not finite.
    #[error("view {view}: the pixel is ({u}, {v}); leave the view out")]
    Pixel {
        /// Index of the view.
        view: usize,
        /// Column given, in pixels.
        u: f64,
        /// Row given, in pixels.
        v: f64,
    },
    /// The standard deviation is not a positive, finite number, or one over it is infinite.
    #[error("view {view}: sigma is {sigma}; give a positive, finite number of pixels")]
    Sigma {
        /// Index of the view.
        view: usize,
        /// The value given, in pixels.
        sigma: f64,
    },
    /// The intrinsics or the pose are none.
    #[error("view {view}: the intrinsics or the pose are not those of a camera; check its numbers")]
    Camera {
        /// Index of the view.
        view: usize,
    },
    /// A direction does not point into the picture.
    #[error("the direction has z = {z}; give one that points forward")]
    Direction {
        /// Its component along the optical axis.
        z: f64,
    },
    /// All cameras have one centre: a pure rotation.
    #[error("the camera centres lie within {length:e} m of one place; a turn shows no depth")]
    NoBaseline {
        /// Root mean square of the distances from their mean, in metres.
        length: f64,
    },
    /// The rays are too nearly parallel.
    #[error(
        "the widest angle between two rays is {angle:.2e} rad, less than {least:.2e} rad; wait \
         until the camera has moved farther"
    )]
    Parallax {
        /// The widest angle, in radians.
        angle: f64,
        /// The least that was asked for, in radians.
        least: f64,
    },
    /// The rays are parallel as far as rounding can tell.
    #[error(
        "the point is at infinity: the rays meet at no finite place, and the widest angle between \
         two of them is {angle:.2e} rad; wait until the camera has moved farther"
    )]
    AtInfinity {
        /// The widest angle, in radians.
        angle: f64,
    },
    /// Residuals have no square that is a number.
    #[error("the squares of the residuals are too large; give a larger sigma")]
    TooLarge,
    /// The rays meet behind a camera, or nearer than it can see; or a start lies there.
    #[error(
        "the point lies at a depth of {depth} m in view {view}; the pixels do not show one point, or the \
         start is behind a view"
    )]
    Behind {
        /// Index of the view.
        view: usize,
        /// Depth in this view, in metres.
        depth: f64,
    },
    /// The views do not fix all three coordinates.
    #[error(
        "the information about the point has the condition number {condition:.1e}; its depth is \
         not in the pictures"
    )]
    Undetermined {
        /// Largest over smallest eigenvalue of the 3×3 information matrix.
        condition: f64,
    },
    /// The steps did not come to rest.
    #[error("no minimum after {iterations} steps, the last of them {step:.1e} standard deviations")]
    NotConverged {
        /// How many steps were made.
        iterations: usize,
        /// Length of the last step in standard deviations.
        step: f64,
    },
}
