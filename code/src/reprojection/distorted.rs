//! A pinhole behind a lens that distorts.

use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, Unit, Vector2, Vector3};

use super::{Pinhole, Projection, RadialTangential, UndistortError};
use crate::manifold::se3;

// ANCHOR: distorted_pinhole
/// A pinhole camera with lens distortion, as calibration tools describe it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistortedPinhole {
    /// Focal lengths and principal point.
    pub pinhole: Pinhole,
    /// What the lens does before them.
    pub lens: RadialTangential,
}
// ANCHOR_END: distorted_pinhole

impl DistortedPinhole {
    /// Pixel of a point in camera coordinates (metres), or `None` as in
    /// [`Pinhole::project_cam`], and also when the point lies so far off the axis that the
    /// lens model folds over, beyond [`RadialTangential::monotonic_radius`], or where its
    /// tangential part keeps the Jacobian from being positive definite.
    pub fn project_cam(&self, point_in_camera: &Vector3<f64>) -> Option<Vector2<f64>> {
        let (pixel, _) = self.project_cam_with_jacobian(point_in_camera)?;
        Some(pixel)
    }

    /// Pixel of a point in world coordinates (metres), or `None` as in
    /// [`DistortedPinhole::project_cam`].
    pub fn project(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Vector2<f64>> {
        self.project_cam(&se3::transform(camera_from_world, point_in_world))
    }

    /// The 2×3 Jacobian of the pixel by the point in camera coordinates, in pixels per
    /// metre, or `None` as in [`DistortedPinhole::project_cam`].
    pub fn projection_jacobian(&self, point_in_camera: &Vector3<f64>) -> Option<Matrix2x3<f64>> {
        let (_, jacobian) = self.project_cam_with_jacobian(point_in_camera)?;
        Some(jacobian)
    }

    // ANCHOR: distorted_jacobian
    /// Pixel of a point in camera coordinates (metres) with its 2×3 Jacobian by the point, in
    /// pixels per metre, or `None` as in [`DistortedPinhole::project_cam`]. The Jacobian of the
    /// lens, {eq:distortion-jacobian}, stands between focal lengths and perspective.
    pub fn project_cam_with_jacobian(
        &self,
        point_in_camera: &Vector3<f64>,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        let depth = point_in_camera.z;
        let ideal = point_in_camera.xy() / depth;
        let (distorted, by_ideal) = self.lens.shown(&ideal)?;
        let pixel = self.pinhole.project_cam(&(depth * distorted).push(depth))?;
        let bend = by_ideal / depth;
        let mut jacobian = Matrix2x3::zeros();
        jacobian.fixed_columns_mut::<2>(0).copy_from(&bend);
        jacobian.set_column(2, &(-bend * ideal));
        jacobian.row_mut(0).scale_mut(self.pinhole.fx);
        jacobian.row_mut(1).scale_mut(self.pinhole.fy);
        Some((pixel, jacobian))
    }
    // ANCHOR_END: distorted_jacobian

    /// Pixel of a point in world coordinates (metres) with its Jacobians by the pose and
    /// by the point, or `None` as in [`DistortedPinhole::project_cam`].
    pub fn project_with_jacobians(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<Projection> {
        let rotation = camera_from_world.rotation.to_rotation_matrix().into_inner();
        let point_in_camera = rotation * point_in_world + camera_from_world.translation.vector;
        let (pixel, by_camera_point) = self.project_cam_with_jacobian(&point_in_camera)?;
        Projection::new(pixel, &by_camera_point, &rotation, point_in_world)
    }

    /// The 2×6 Jacobian of the pixel by the pose and the 2×3 Jacobian by the point in the
    /// world, as [`Pinhole::jacobians`].
    pub fn jacobians(
        &self,
        camera_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<(Matrix2x6<f64>, Matrix2x3<f64>)> {
        let projection = self.project_with_jacobians(camera_from_world, point_in_world)?;
        Some((projection.by_pose, projection.by_point))
    }

    // ANCHOR: unproject
    /// The point one metre in front of the camera that it sees at a pixel, as (X/Z, Y/Z).
    ///
    /// # Errors
    ///
    /// [`UndistortError`] when the lens model shows nothing at this pixel.
    pub fn unproject(&self, pixel: &Vector2<f64>) -> Result<Vector2<f64>, UndistortError> {
        let Pinhole { fx, fy, cx, cy } = self.pinhole;
        self.lens.undistort(&Vector2::new((pixel.x - cx) / fx, (pixel.y - cy) / fy))
    }

    /// Direction, in camera coordinates, in which the camera sees a pixel.
    ///
    /// # Errors
    ///
    /// As [`DistortedPinhole::unproject`].
    pub fn bearing(&self, pixel: &Vector2<f64>) -> Result<Unit<Vector3<f64>>, UndistortError> {
        Ok(Unit::new_normalize(self.unproject(pixel)?.push(1.0)))
    }
    // ANCHOR_END: unproject
}
