//! The pinhole camera: from a point in space to a pixel.

use nalgebra::{Isometry3, Vector2, Vector3};
use thiserror::Error;

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
    /// `camera_from_world` is the inverse of the camera's pose; its translation is not
    /// the camera's position.
    pub fn project(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Vector2<f64>> {
        let rotated = camera_from_world.rotation * point_in_world;
        self.project_cam(&(rotated + camera_from_world.translation.vector))
    }
    // ANCHOR_END: project
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
