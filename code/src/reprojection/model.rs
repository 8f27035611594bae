//! What any camera model does to a point in front of it.

use nalgebra::{Matrix2x3, Vector2, Vector3};

use super::{DistortedPinhole, Pinhole};

// ANCHOR: camera_model
/// A camera without its place: what takes points in camera coordinates to pixels.
pub trait CameraModel: Clone + Send + Sync + 'static {
    /// Pixel of a point in camera coordinates (metres), or `None` where there is none.
    fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>>;

    /// The 2×3 Jacobian of the pixel by the point in camera coordinates, in pixels per metre.
    fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>>;

    /// Both at once.
    #[inline(always)]
    fn project_cam_with_jacobian(
        &self,
        point_in_camera: &Vector3<f64>,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        Some((self.project_cam(point_in_camera)?, self.projection_jacobian(point_in_camera)?))
    }
}
// ANCHOR_END: camera_model

impl CameraModel for Pinhole {
    #[inline(always)]
    fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project_cam(point_in_camera)
    }

    #[inline(always)]
    fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
        self.projection_jacobian(point_in_camera)
    }
}

impl CameraModel for DistortedPinhole {
    fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project_cam(point_in_camera)
    }

    fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
        self.projection_jacobian(point_in_camera)
    }

    fn project_cam_with_jacobian(
        &self,
        point_in_camera: &Vector3<f64>,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        self.project_cam_with_jacobian(point_in_camera)
    }
}
