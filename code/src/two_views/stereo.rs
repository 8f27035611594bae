//! Two lenses at a known distance: a camera with a ruler.

use nalgebra::{Isometry3, Matrix3, Matrix3x6, Vector2, Vector3};
use thiserror::Error;

use crate::bearing::{back_project, depth_from_disparity};
use crate::reprojection::Pinhole;

// ANCHOR: stereo_pinhole
/// Two cameras of one make that look the same way, the right one `baseline` metres along the
/// x axis of the left one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoPinhole {
    /// Intrinsics of either camera.
    pub camera: Pinhole,
    /// Metres from the left centre to the right one.
    pub baseline: f64,
}

/// What the pair sees of a point and what moves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoProjection {
    /// Column in the left image, row in both, column in the right image; in pixels.
    pub observation: Vector3<f64>,
    /// By the twist ξ = (ρ, φ) of T exp(ξ), T being the pose of the left camera.
    pub by_pose: Matrix3x6<f64>,
    /// By the point in world coordinates, in pixels per metre.
    pub by_point: Matrix3<f64>,
}
// ANCHOR_END: stereo_pinhole

impl StereoPinhole {
    /// A pair of cameras `baseline` metres apart.
    ///
    /// # Errors
    ///
    /// [`StereoError::Baseline`] when the baseline is no ruler.
    pub fn new(camera: Pinhole, baseline: f64) -> Result<Self, StereoError> {
        if !(baseline > 0.0 && baseline.is_finite()) {
            return Err(StereoError::Baseline { baseline });
        }
        Ok(Self { camera, baseline })
    }

    /// Takes coordinates in the left camera to the right one.
    pub fn right_from_left(&self) -> Isometry3<f64> {
        Isometry3::translation(-self.baseline, 0.0, 0.0)
    }

    // ANCHOR: stereo_project
    /// What the pair sees of a point in world coordinates (metres), with its Jacobians, or
    /// `None` when the point is not in front of it.
    ///
    /// A step of the left camera, T exp(ξ), is the same ξ for the right one. Implements
    /// {eq:stereo-projection} and {eq:stereo-blocks}.
    pub fn project_with_jacobians(
        &self,
        left_from_world: &Isometry3<f64>,
        point_in_world: &Vector3<f64>,
    ) -> Option<StereoProjection> {
        let left = self.camera.project_with_jacobians(left_from_world, point_in_world)?;
        let right_from_world = self.right_from_left() * left_from_world;
        let right = self.camera.project_with_jacobians(&right_from_world, point_in_world)?;
        let mut by_pose = left.by_pose.insert_row(2, 0.0);
        by_pose.row_mut(2).copy_from(&right.by_pose.row(0));
        let mut by_point = left.by_point.insert_row(2, 0.0);
        by_point.row_mut(2).copy_from(&right.by_point.row(0));
        let observation = left.pixel.push(right.pixel.x);
        Some(StereoProjection { observation, by_pose, by_point })
    }
    // ANCHOR_END: stereo_project

    /// The point in the left camera, in metres, that has an observation, or `None` when its
    /// disparity is not positive: it would lie at infinity or beyond.
    pub fn point(&self, observation: &Vector3<f64>) -> Option<Vector3<f64>> {
        let disparity = observation.x - observation.z;
        let depth = depth_from_disparity(&self.camera, self.baseline, disparity)?;
        let pixel = Vector2::new(observation.x, observation.y);
        Some(back_project(&self.camera, &pixel, depth))
    }
}

// ANCHOR: stereo_factor
/// One stereo keyframe saw one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoFactor {
    /// Index of the keyframe.
    pub keyframe: usize,
    /// Index of the point.
    pub point: usize,
    /// Column in the left image, row, column in the right image, as measured.
    pub observation: Vector3<f64>,
    /// One over the standard deviation of each of the three, in 1/pixel.
    pub inverse_sigma: f64,
}

/// A whitened residual and its Jacobians: without unit, with noise of variance one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizedStereo {
    /// Predicted minus measured, over the standard deviation.
    pub residual: Vector3<f64>,
    /// By the twist ξ = (ρ, φ) of T exp(ξ), T being the pose of the left camera.
    pub by_pose: Matrix3x6<f64>,
    /// By the point in world coordinates.
    pub by_point: Matrix3<f64>,
}
// ANCHOR_END: stereo_factor

impl StereoFactor {
    /// An observation with independent noise of `sigma` pixels in each of its three numbers.
    ///
    /// # Errors
    ///
    /// [`StereoError`] when the observation or `sigma` cannot have been measured.
    pub fn new(
        keyframe: usize,
        point: usize,
        observation: Vector3<f64>,
        sigma: f64,
    ) -> Result<Self, StereoError> {
        let [u_left, v, u_right] = observation.into();
        if !(u_left.is_finite() && v.is_finite() && u_right.is_finite()) {
            return Err(StereoError::Observation { keyframe, point, u_left, v, u_right });
        }
        let inverse_sigma = sigma.recip();
        if !(sigma > 0.0 && sigma.is_finite() && inverse_sigma.is_finite()) {
            return Err(StereoError::Sigma { keyframe, point, sigma });
        }
        Ok(Self { keyframe, point, observation, inverse_sigma })
    }

    // ANCHOR: stereo_linearize
    /// The whitened residual and its Jacobians for what a stereo camera predicts.
    pub fn linearize(&self, predicted: &StereoProjection) -> LinearizedStereo {
        LinearizedStereo {
            residual: self.inverse_sigma * (predicted.observation - self.observation),
            by_pose: self.inverse_sigma * predicted.by_pose,
            by_point: self.inverse_sigma * predicted.by_point,
        }
    }
    // ANCHOR_END: stereo_linearize
}

/// Why a stereo camera or a measurement of one is none.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StereoError {
    /// The baseline is zero, negative or not finite.
    #[error("the baseline is {baseline}; give a positive, finite number of metres")]
    Baseline {
        /// The value given, in metres.
        baseline: f64,
    },
    /// A coordinate is not finite.
    #[error(
        "keyframe {keyframe}, point {point}: the observation is ({u_left}, {v}, {u_right}); \
         leave it out"
    )]
    Observation {
        /// Index of the keyframe.
        keyframe: usize,
        /// Index of the point.
        point: usize,
        /// Column in the left image, in pixels.
        u_left: f64,
        /// Row, in pixels.
        v: f64,
        /// Column in the right image, in pixels.
        u_right: f64,
    },
    /// The standard deviation is zero, negative, not finite, or too small to divide by.
    #[error(
        "keyframe {keyframe}, point {point}: sigma is {sigma}; \
         give a positive, finite number of pixels"
    )]
    Sigma {
        /// Index of the keyframe.
        keyframe: usize,
        /// Index of the point.
        point: usize,
        /// The value given, in pixels.
        sigma: f64,
    },
}
