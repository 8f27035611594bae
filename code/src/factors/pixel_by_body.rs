//! A pixel by the state of the body that carries the camera, the point that it shows, how the
//! camera sits on the body and how late its clock is.

use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, SMatrix, Vector1, Vector2, Vector3};

use super::exposure::Exposure;
use crate::inertial::{BodyPose, NavState};
use crate::least_squares::{Factor, Key};
use crate::manifold::so3;
use crate::reprojection::CameraModel;

// ANCHOR: by_state
/// The twist of `camera_from_world`, as its right retraction takes it, of a step (φ, v, p) of the
/// state: a 6×9 matrix. Neither the lever arm nor the camera's orientation appears in it.
///
/// Implements {eq:twist-by-state}.
pub fn twist_by_state(state: &NavState) -> SMatrix<f64, 6, 9> {
    let world_from_body = state.world_from_body.matrix();
    let mut twist = SMatrix::<f64, 6, 9>::zeros();
    let rho_by_phi = -so3::hat(&state.position) * world_from_body;
    twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&rho_by_phi);
    twist.fixed_view_mut::<3, 3>(0, 6).fill_diagonal(-1.0);
    twist.fixed_view_mut::<3, 3>(3, 0).copy_from(&-world_from_body);
    twist
}
// ANCHOR_END: by_state

// ANCHOR: pixel_by_state
/// The 2×9 derivative of a pixel by a step (φ, v, p) of the state, from the 2×3 derivative by the
/// landmark. Implements {eq:pixel-by-state}.
pub fn pixel_by_state(
    state: &NavState,
    landmark: &Vector3<f64>,
    by_point: &Matrix2x3<f64>,
) -> SMatrix<f64, 2, 9> {
    let arm = so3::hat(&(landmark - state.position));
    let mut jacobian = SMatrix::<f64, 2, 9>::zeros();
    let by_phi = by_point * arm * state.world_from_body.matrix();
    jacobian.fixed_view_mut::<2, 3>(0, 0).copy_from(&by_phi);
    jacobian.fixed_view_mut::<2, 3>(0, 6).copy_from(&-by_point);
    jacobian
}
// ANCHOR_END: pixel_by_state

// ANCHOR: pixel_by_body
/// A pixel at which a camera on a moving body saw a landmark.
#[derive(Debug, Clone, Copy)]
pub struct PixelByBody<M> {
    /// The state of the body when the sensor's clock showed the time that the picture has on the
    /// camera's.
    pub state: Key<NavState>,
    /// The landmark, in world coordinates.
    pub landmark: Key<Vector3<f64>>,
    /// How the camera sits on the body: `body_from_camera`.
    pub extrinsics: Key<Isometry3<f64>>,
    /// What to add to the camera's time to get the sensor's, in seconds.
    pub time_offset: Key<Vector1<f64>>,
    /// The camera.
    pub camera: M,
    /// The body's angular velocity at that time, in its frame, in rad/s: a reading less the bias.
    /// It enters only through the time offset.
    pub angular_velocity: Vector3<f64>,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over its standard deviation, in 1/pixel.
    pub inverse_sigma: f64,
}

/// Values of the variables of a [`PixelByBody`].
type Around<'a> = (&'a NavState, &'a Vector3<f64>, &'a Isometry3<f64>, &'a Vector1<f64>);

/// Derivatives by a step of each.
type ByBody = (SMatrix<f64, 2, 9>, Matrix2x3<f64>, Matrix2x6<f64>, Vector2<f64>);

/// A pixel of a [`PixelByBody`] by the pose that the body had when the picture was taken, so that no
/// clock matters, and without names of variables: for filters, which have a state of their own.
#[derive(Debug, Clone, Copy)]
pub struct BodyPixel<'a, M> {
    /// The camera.
    pub camera: &'a M,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over its standard deviation, in 1/pixel.
    pub inverse_sigma: f64,
}

/// The body, a landmark in the world, and `body_from_camera`.
type Seen<'a> = (&'a BodyPose, &'a Vector3<f64>, &'a Isometry3<f64>);

/// Derivatives by a step of each.
type BySeen = (Matrix2x6<f64>, Matrix2x3<f64>, Matrix2x6<f64>);

/// The landmark in camera coordinates. It goes through the body's frame, so that no rotation is made
/// from two.
fn in_camera((body, landmark, extrinsics): Seen) -> Vector3<f64> {
    let in_body = body.world_from_body.inverse_transform_vector(&(landmark - body.position));
    let from_camera = in_body - extrinsics.translation.vector;
    extrinsics.rotation.inverse_transform_vector(&from_camera)
}

impl<M: CameraModel> BodyPixel<'_, M> {
    /// Prediction minus measurement, in standard deviations; `None` for a landmark that is not in
    /// front of the camera.
    pub fn residual(&self, seen: Seen) -> Option<Vector2<f64>> {
        Some(self.inverse_sigma * (self.camera.project_cam(&in_camera(seen))? - self.pixel))
    }

    // ANCHOR: body_pixel_linearize
    /// The residual and its derivatives: 2×6 by a step (φ, p) of the body, the columns of
    /// {eq:pixel-by-state} without those of the velocity; 2×3 by the landmark; and 2×6 by the
    /// extrinsics T_bc exp(ξ), with which the point in the camera moves by −ρ + P_c × φ.
    pub fn linearize(&self, seen: Seen) -> Option<(Vector2<f64>, BySeen)> {
        let (body, landmark, extrinsics) = seen;
        let point = in_camera(seen);
        let (pixel, by_camera_point) = self.camera.project_cam_with_jacobian(&point)?;
        let residual = self.inverse_sigma * (pixel - self.pixel);
        let by_camera_point = self.inverse_sigma * by_camera_point;
        let camera_from_body = extrinsics.rotation.to_rotation_matrix().transpose();
        let camera_from_world = camera_from_body * body.world_from_body.transpose();
        let by_landmark = by_camera_point * camera_from_world.matrix();
        let by_state = pixel_by_state(&body.at_rest(), landmark, &by_landmark);
        let mut by_body = Matrix2x6::zeros();
        by_body.fixed_columns_mut::<3>(0).copy_from(&by_state.fixed_columns::<3>(0));
        by_body.fixed_columns_mut::<3>(3).copy_from(&by_state.fixed_columns::<3>(6));
        let mut by_extrinsics = Matrix2x6::zeros();
        by_extrinsics.fixed_columns_mut::<3>(0).copy_from(&-by_camera_point);
        let turned = by_camera_point * so3::hat(&point);
        by_extrinsics.fixed_columns_mut::<3>(3).copy_from(&turned);
        Some((residual, (by_body, by_landmark, by_extrinsics)))
    }
    // ANCHOR_END: body_pixel_linearize
}

impl<M: CameraModel> PixelByBody<M> {
    fn measured(&self) -> BodyPixel<'_, M> {
        let Self { ref camera, pixel, inverse_sigma, .. } = *self;
        BodyPixel { camera, pixel, inverse_sigma }
    }

    fn exposure(&self) -> Exposure<'_> {
        Exposure { angular_velocity: &self.angular_velocity }
    }
}

impl<M: CameraModel> Factor<2> for PixelByBody<M> {
    type Variables = (NavState, Vector3<f64>, Isometry3<f64>, Vector1<f64>);
    type Jacobians = ByBody;

    fn variables(
        &self,
    ) -> (Key<NavState>, Key<Vector3<f64>>, Key<Isometry3<f64>>, Key<Vector1<f64>>) {
        (self.state, self.landmark, self.extrinsics, self.time_offset)
    }

    fn residual(&self, (state, landmark, extrinsics, offset): Around) -> Option<Vector2<f64>> {
        let body = self.exposure().body(state, offset.x);
        self.measured().residual((&body, landmark, extrinsics))
    }

    // ANCHOR: pixel_by_body_linearize
    /// Implements {eq:pixel-by-state}, carried from the picture back to the state, which is earlier by the
    /// time offset.
    fn linearize(
        &self,
        (state, landmark, extrinsics, offset): Around,
    ) -> Option<(Vector2<f64>, ByBody)> {
        let body = self.exposure().body(state, offset.x);
        let (residual, (by_body, by_landmark, by_extrinsics)) =
            self.measured().linearize((&body, landmark, extrinsics))?;
        let (by_state, by_offset) = self.exposure().carry(&by_body, state, offset.x);
        Some((residual, (by_state, by_landmark, by_extrinsics, by_offset)))
    }
    // ANCHOR_END: pixel_by_body_linearize
}
