//! One observation of one point, as an estimator uses it.

use nalgebra::{Matrix2x3, Matrix2x6, Vector2};
use thiserror::Error;

use super::Projection;

// ANCHOR: factor
/// One keyframe saw one point at one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReprojFactor {
    /// Index of the keyframe.
    pub keyframe: usize,
    /// Index of the point.
    pub point: usize,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over the standard deviation of the pixel, in 1/pixel, the same in all
    /// directions.
    pub inverse_sigma: f64,
}

/// A whitened residual and its Jacobians: without unit, with noise of variance one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizedReproj {
    /// Predicted minus measured, over the standard deviation.
    pub residual: Vector2<f64>,
    /// By the twist ξ = (ρ, φ) of T exp(ξ).
    pub by_pose: Matrix2x6<f64>,
    /// By the point in world coordinates.
    pub by_point: Matrix2x3<f64>,
}
// ANCHOR_END: factor

impl ReprojFactor {
    /// An observation with noise of `sigma` pixels.
    ///
    /// # Errors
    ///
    /// [`ReprojFactorError`] when the pixel or `sigma` cannot have been measured.
    pub fn new(
        keyframe: usize,
        point: usize,
        pixel: Vector2<f64>,
        sigma: f64,
    ) -> Result<Self, ReprojFactorError> {
        if !(pixel.x.is_finite() && pixel.y.is_finite()) {
            let (u, v) = (pixel.x, pixel.y);
            return Err(ReprojFactorError::Pixel { keyframe, point, u, v });
        }
        let inverse_sigma = sigma.recip();
        if !(sigma > 0.0 && sigma.is_finite() && inverse_sigma.is_finite()) {
            return Err(ReprojFactorError::Sigma { keyframe, point, sigma });
        }
        Ok(Self { keyframe, point, pixel, inverse_sigma })
    }

    // ANCHOR: linearize
    /// The whitened residual for the pixel that a camera predicts.
    ///
    /// Implements {eq:reprojection-residual}.
    pub fn residual(&self, predicted: &Vector2<f64>) -> Vector2<f64> {
        self.inverse_sigma * (predicted - self.pixel)
    }

    /// The whitened residual and its Jacobians.
    ///
    /// Implements {eq:factor-blocks}.
    pub fn linearize(&self, predicted: &Projection) -> LinearizedReproj {
        LinearizedReproj {
            residual: self.residual(&predicted.pixel),
            by_pose: self.inverse_sigma * predicted.by_pose,
            by_point: self.inverse_sigma * predicted.by_point,
        }
    }
    // ANCHOR_END: linearize
}

/// Why a measurement is none.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ReprojFactorError {
    /// A coordinate of the pixel is not finite.
    #[error(
        "keyframe {keyframe}, point {point}: the pixel is ({u}, {v}); leave the observation out"
    )]
    Pixel {
        /// Index of the keyframe.
        keyframe: usize,
        /// Index of the point.
        point: usize,
        /// Column given, in pixels.
        u: f64,
        /// Row given, in pixels.
        v: f64,
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
