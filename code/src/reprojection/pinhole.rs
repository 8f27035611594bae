//! The pinhole camera: from a point in space to a pixel.

use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, Matrix3, Vector2, Vector3};
use thiserror::Error;

use crate::manifold::se3;

// ANCHOR: pinhole
/// A pinhole camera without lens distortion. All four values are in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Focal length along the image rows.
    pub fx: f64,
    /// Focal length along the image columns.
    pub fy: f64,
    /// Column of the principal point, where the optical axis meets the image.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
}

/// Points nearer to the camera than this depth, in metres, have no pixel.
pub const Z_MIN: f64 = 0.05;
// ANCHOR_END: pinhole

impl Pinhole {
    /// A camera with focal lengths `fx`, `fy` and principal point (`cx`, `cy`), all in
    /// pixels.
    ///
    /// # Errors
    ///
    /// [`PinholeError`] names the first value that no camera can have.
    pub fn new(fx: f64, fy: f64, cx: f64, cy: f64) -> Result<Self, PinholeError> {
        for (name, value) in [("fx", fx), ("fy", fy)] {
            if !value.is_finite() || value <= 0.0 {
                return Err(PinholeError::FocalLength { name, value });
            }
        }
        for (name, value) in [("cx", cx), ("cy", cy)] {
            if !value.is_finite() {
                return Err(PinholeError::PrincipalPoint { name, value });
            }
        }
        Ok(Self { fx, fy, cx, cy })
    }

    // ANCHOR: project_cam
    /// Pixel of a point in camera coordinates (metres), or `None` when the point is not
    /// farther than [`Z_MIN`] in front of the camera. A pixel is always finite: a point
    /// with a NaN coordinate has none.
    ///
    /// Implements {eq:projection}.
    pub fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        let depth = point_in_camera.z;
        let u = self.fx * point_in_camera.x / depth + self.cx;
        let v = self.fy * point_in_camera.y / depth + self.cy;
        (depth > Z_MIN && u.is_finite() && v.is_finite()).then_some(Vector2::new(u, v))
    }
    // ANCHOR_END: project_cam

    // ANCHOR: project
    /// Pixel of a point in world coordinates (metres), or `None` as in
    /// [`Pinhole::project_cam`].
    ///
    /// `camera_from_world` takes coordinates in the world to the camera; its translation is
    /// not the camera's position.
    pub fn project(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Vector2<f64>> {
        self.project_cam(&se3::transform(camera_from_world, point_in_world))
    }
    // ANCHOR_END: project

    // ANCHOR: projection_jacobian
    /// The 2×3 Jacobian of the pixel by the point in camera coordinates, in pixels per
    /// metre, or `None` as in [`Pinhole::project_cam`].
    ///
    /// Implements {eq:projection-jacobian}.
    pub fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
        self.project_cam(point_in_camera)?;
        let inverse_depth = point_in_camera.z.recip();
        let slope = inverse_depth * point_in_camera.xy();
        let (fx, fy) = (self.fx * inverse_depth, self.fy * inverse_depth);
        Some(Matrix2x3::new(fx, 0.0, -fx * slope.x, 0.0, fy, -fy * slope.y))
    }
    // ANCHOR_END: projection_jacobian

    // ANCHOR: project_with_jacobians
    /// Pixel of a point in world coordinates (metres) with its Jacobians by the pose and
    /// by the point, or `None` as in [`Pinhole::project_cam`]. All entries are finite.
    ///
    /// Implements {eq:pose-block} and {eq:point-block}.
    pub fn project_with_jacobians(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Projection> {
        // A matrix turns the point and stands in both blocks; a quaternion would only do the first.
        let rotation = camera_from_world.rotation.to_rotation_matrix().into_inner();
        let point_in_camera = rotation * point_in_world + camera_from_world.translation.vector;
        let pixel = self.project_cam(&point_in_camera)?;
        let by_camera_point = self.projection_jacobian(&point_in_camera)?;
        Projection::new(pixel, &by_camera_point, &rotation, point_in_world)
    }
    // ANCHOR_END: project_with_jacobians

    // ANCHOR: jacobians
    /// The 2×6 Jacobian of the pixel by the pose and the 2×3 Jacobian by the point in the
    /// world: the blocks of [`Pinhole::project_with_jacobians`] without the pixel.
    pub fn jacobians(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<(Matrix2x6<f64>, Matrix2x3<f64>)> {
        let projection = self.project_with_jacobians(camera_from_world, point_in_world)?;
        Some((projection.by_pose, projection.by_point))
    }
    // ANCHOR_END: jacobians
}

// ANCHOR: projection
/// A pixel and what moves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Where the camera sees the point, in pixels.
    pub pixel: Vector2<f64>,
    /// By the twist ξ = (ρ, φ) of T exp(ξ): three columns in pixels per metre, then three
    /// in pixels per radian.
    pub by_pose: Matrix2x6<f64>,
    /// By the point in world coordinates, in pixels per metre.
    pub by_point: Matrix2x3<f64>,
}
// ANCHOR_END: projection

impl Projection {
    // ANCHOR: blocks
    /// Both blocks of a camera whose pixel changes by `by_camera_point` with the point in
    /// camera coordinates; `None` when an entry is not finite.
    pub(super) fn new(
        pixel: Vector2<f64>,
        by_camera_point: &Matrix2x3<f64>,
        rotation: &Matrix3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Self> {
        // A row a of the point block times -[P]× is P × a: no matrix [P]× is needed.
        let [x, y, z] = [0, 1, 2].map(|row| rotation.row(row).transpose());
        let [u, v] = [0, 1].map(|row| {
            let a = by_camera_point.row(row);
            a[0] * x + a[1] * y + a[2] * z
        });
        let (turn_u, turn_v) = (point_in_world.cross(&u), point_in_world.cross(&v));
        #[rustfmt::skip]
        let by_pose = Matrix2x6::new(
            u.x, u.y, u.z, turn_u.x, turn_u.y, turn_u.z,
            v.x, v.y, v.z, turn_v.x, turn_v.y, turn_v.z,
        );
        // Without a branch for each entry the processor tests several at once.
        let is_finite = by_pose.iter().fold(true, |all, entry| all & entry.is_finite());
        let by_point = Matrix2x3::new(u.x, u.y, u.z, v.x, v.y, v.z);
        is_finite.then_some(Self { pixel, by_pose, by_point })
    }
    // ANCHOR_END: blocks
}

/// Why four numbers are not a camera.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PinholeError {
    /// A focal length is zero, negative or not finite.
    #[error("focal length {name} is {value}; give a positive, finite number of pixels")]
    FocalLength {
        /// `fx` or `fy`.
        name: &'static str,
        /// The value given, in pixels.
        value: f64,
    },
    /// A coordinate of the principal point is not finite.
    #[error("principal point {name} is {value}; give a finite number of pixels")]
    PrincipalPoint {
        /// `cx` or `cy`.
        name: &'static str,
        /// The value given, in pixels.
        value: f64,
    },
}

impl PinholeError {
    /// `fx`, `fy`, `cx` or `cy`.
    pub fn name(&self) -> &'static str {
        let (Self::FocalLength { name, .. } | Self::PrincipalPoint { name, .. }) = self;
        name
    }
}
