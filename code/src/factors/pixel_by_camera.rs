//! A pixel by the camera that saw it and the point that it shows.

use nalgebra::{Matrix2x3, SMatrix, SVector, Vector2, Vector3};

use crate::bundle_adjustment::Camera;
use crate::least_squares::{Factor, Key, Manifold};

// ANCHOR: moving_camera
/// A camera as a variable that moves in `D` directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingCamera<C, const D: usize>(pub C);

impl<C: Camera<D>, const D: usize> Manifold for MovingCamera<C, D> {
    fn dimension(&self) -> usize {
        D
    }

    fn retract(&self, step: &[f64]) -> Self {
        Self(self.0.retract(&SVector::from_column_slice(step)))
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        step.copy_from_slice(self.0.local(&to.0).as_slice());
    }

    fn local_jacobian(&self, to: &Self, into: &mut [f64]) {
        into.copy_from_slice(self.0.local_jacobian(&to.0).as_slice());
    }
}
// ANCHOR_END: moving_camera

// ANCHOR: pixel_by_camera
/// A pixel at which a camera saw a landmark.
#[derive(Debug, Clone, Copy)]
pub struct PixelByCamera<C, const D: usize> {
    /// The camera.
    pub camera: Key<MovingCamera<C, D>>,
    /// The landmark, in world coordinates.
    pub landmark: Key<Vector3<f64>>,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over its standard deviation, in 1/pixel.
    pub inverse_sigma: f64,
}

impl<C: Camera<D>, const D: usize> Factor<2> for PixelByCamera<C, D> {
    type Variables = (MovingCamera<C, D>, Vector3<f64>);
    type Jacobians = (SMatrix<f64, 2, D>, Matrix2x3<f64>);

    #[inline(always)]
    fn variables(&self) -> (Key<MovingCamera<C, D>>, Key<Vector3<f64>>) {
        (self.camera, self.landmark)
    }

    // ANCHOR: pixel_by_camera_residual
    #[inline(always)]
    fn residual(
        &self,
        (camera, landmark): (&MovingCamera<C, D>, &Vector3<f64>),
    ) -> Option<Vector2<f64>> {
        Some(self.inverse_sigma * (camera.0.project(landmark)? - self.pixel))
    }

    #[inline(always)]
    fn linearize(
        &self,
        (camera, landmark): (&MovingCamera<C, D>, &Vector3<f64>),
    ) -> Option<(Vector2<f64>, Self::Jacobians)> {
        let predicted = camera.0.differentiate(landmark)?;
        let residual = self.inverse_sigma * (predicted.pixel - self.pixel);
        let by_camera = self.inverse_sigma * predicted.by_camera;
        Some((residual, (by_camera, self.inverse_sigma * predicted.by_point)))
    }
    // ANCHOR_END: pixel_by_camera_residual
}
// ANCHOR_END: pixel_by_camera
