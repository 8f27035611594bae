//! The other convention: derivatives of a pixel by a twist on the left of the pose.

use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, Vector2, Vector3};
use serde::{Deserialize, Serialize};
use vislam::reprojection::Pinhole;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

/// A pinhole camera, in pixels. `camera.pinhole()` projects as the library's does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Focal length across.
    pub fx: f64,
    /// Focal length down.
    pub fy: f64,
    /// Column of the principal point.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
}

impl Camera {
    /// The library's camera with these numbers, without its derivatives by a pose.
    pub fn pinhole(&self) -> Lens {
        let Self { fx, fy, cx, cy } = *self;
        Lens(Pinhole { fx, fy, cx, cy })
    }
}

impl From<crate::camera::Camera> for Camera {
    fn from(camera: crate::camera::Camera) -> Self {
        let crate::camera::Camera { fx, fy, cx, cy } = camera;
        Self { fx, fy, cx, cy }
    }
}

/// What of the library's camera does not answer the exercise.
#[derive(Debug, Clone, Copy)]
pub struct Lens(Pinhole);

impl Lens {
    /// The pixel of a point in the camera's frame. `None` when it is not in front of the camera.
    pub fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.0.project_cam(point_in_camera)
    }

    /// The pixel of a point in the world. `None` when it is not in front of the camera.
    pub fn project(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Vector2<f64>> {
        self.0.project(camera_from_world, point_in_world)
    }

    /// The 2×3 derivative of the pixel by the point in the camera's frame.
    pub fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
        self.0.projection_jacobian(point_in_camera)
    }
}

// ANCHOR: side
/// On which side of a pose a twist stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// exp(ξ) T.
    Left,
    /// T exp(ξ), as everywhere else in the book.
    Right,
}
// ANCHOR_END: side

crate::signatures! {
    // ANCHOR: signatures
    /// The derivative of the pixel of a world point by a twist ξ = (ρ, φ) that moves the pose on
    /// the **left**, exp(ξ) T, at ξ = 0. In pixels per metre and per radian. The point is in
    /// front of the camera.
    fn left_pose_jacobian(
        camera: Camera,
        camera_from_world: Isometry3<f64>,
        point_in_world: Vector3<f64>,
    ) -> Matrix2x6<f64>;

    /// The derivative by a twist on the **right** of the pose, T exp(ξ), of something whose
    /// derivative by a twist on the left is given.
    fn right_from_left(camera_from_world: Isometry3<f64>, left: Matrix2x6<f64>) -> Matrix2x6<f64>;
    // ANCHOR_END: signatures

    // ANCHOR: checking
    /// Either derivative by central differences with the step given: in each of the six
    /// directions, half the difference of two pixels over the step. Its error shrinks with the
    /// square of the step.
    fn central_differences(
        camera: Camera,
        camera_from_world: Isometry3<f64>,
        point_in_world: Vector3<f64>,
        side: Side,
        step: f64,
    ) -> Matrix2x6<f64>;

    /// How the pixel of a point moves, in pixels per metre, when the **camera** moves forward
    /// along its optical axis. The point is given in the camera's frame and stays where it is in
    /// the world.
    fn forward_motion(camera: Camera, point_in_camera: Vector3<f64>) -> Vector2<f64>;
    // ANCHOR_END: checking
}
