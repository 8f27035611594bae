//! A camera that is mounted to another one.

use nalgebra::{Isometry3, Matrix2x3, Vector2, Vector3};

use super::{CameraModel, Pinhole, Z_MIN};
use crate::manifold::se3;

// ANCHOR: rig_camera
/// One of several cameras on a rig, by the frame of the first of them: its pixels are those of points
/// in the coordinates of the first camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigCamera {
    /// The camera.
    pub camera: Pinhole,
    /// Takes coordinates in the first camera to this one.
    pub camera_from_first: Isometry3<f64>,
}

impl RigCamera {
    /// The first camera of a rig.
    pub fn first(camera: Pinhole) -> Self {
        Self { camera, camera_from_first: Isometry3::identity() }
    }

    /// Pixel of the point `scaled` / `scale` in the first camera's coordinates, with its 2×3 derivative
    /// by `scaled` and its derivative by `scale`. Nothing is divided by the scale, so zero means a point
    /// at infinity. `None` when the point is not farther than [`Z_MIN`] in front of this camera.
    pub fn project_scaled(
        &self,
        scaled: &Vector3<f64>,
        scale: f64,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>, Vector2<f64>)> {
        let Isometry3 { rotation, translation } = &self.camera_from_first;
        let seen = rotation * scaled + scale * translation.vector;
        if seen.z.is_nan() || seen.z <= Z_MIN * scale.max(0.0) {
            return None;
        }
        // A pixel is that of any point on its ray, and the slopes are less the farther that is.
        let on_ray = seen / seen.z;
        let pixel = self.camera.project_cam(&on_ray)?;
        let by_seen = self.camera.projection_jacobian(&on_ray)? / seen.z;
        let by_scaled = by_seen * rotation.to_rotation_matrix().matrix();
        Some((pixel, by_scaled, by_seen * translation.vector))
    }
}
// ANCHOR_END: rig_camera

impl CameraModel for RigCamera {
    fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.camera.project_cam(&se3::transform(&self.camera_from_first, point_in_camera))
    }

    fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
        let point = se3::transform(&self.camera_from_first, point_in_camera);
        let by_point = self.camera.projection_jacobian(&point)?;
        Some(by_point * self.camera_from_first.rotation.to_rotation_matrix().matrix())
    }
}
