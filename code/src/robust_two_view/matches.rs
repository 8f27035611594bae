//! Two pictures and what is said to be the same in both.

use nalgebra::{Vector2, Vector3};
use thiserror::Error;

use super::RayPair;
use crate::bearing::back_project;
use crate::reprojection::Pinhole;

// ANCHOR: matches
/// Pixels of a first and a second picture that are said to show the same points, not all of them
/// rightly.
///
/// Where a lens bends the image, undistort the pixels first.
#[derive(Debug, Clone, PartialEq)]
pub struct Matches {
    /// The slopes in both cameras, with a one below.
    pub(super) rays: Vec<RayPair>,
    /// The same, in standard deviations from the principal point: x, y, and x, y in the second.
    pub(super) scaled: Vec<[f64; 4]>,
    /// The standard deviations of the slopes of both pictures.
    pub(super) sigmas: [Vector2<f64>; 2],
}
// ANCHOR_END: matches

impl Matches {
    /// Matches of pixels that were measured with a standard deviation of `sigma` pixels, in each
    /// coordinate of both.
    ///
    /// # Errors
    ///
    /// [`MatchError`] names the first number that cannot be one.
    pub fn new(
        cameras: [&Pinhole; 2],
        pixels: &[[Vector2<f64>; 2]],
        sigma: f64,
    ) -> Result<Self, MatchError> {
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(MatchError::Sigma { sigma });
        }
        for (camera, Pinhole { fx, fy, cx, cy }) in cameras.into_iter().enumerate() {
            Pinhole::new(*fx, *fy, *cx, *cy).map_err(|_| MatchError::Camera { camera })?;
        }
        let is_finite = |pixel: &Vector2<f64>| pixel.x.is_finite() && pixel.y.is_finite();
        if let Some(at) = pixels.iter().position(|pair| !pair.iter().all(is_finite)) {
            return Err(MatchError::Pixel { at });
        }
        let sigmas = cameras.map(|camera| Vector2::new(sigma / camera.fx, sigma / camera.fy));
        let ray = |pair: &[Vector2<f64>; 2], at: usize| back_project(cameras[at], &pair[at], 1.0);
        let rays: Vec<RayPair> = pixels.iter().map(|pair| (ray(pair, 0), ray(pair, 1))).collect();
        let scaled = rays.iter().map(|(first, second)| {
            let [a, b] = [(first, 0), (second, 1)]
                .map(|(ray, at): (&Vector3<f64>, usize)| ray.xy().component_div(&sigmas[at]));
            [a.x, a.y, b.x, b.y]
        });
        Ok(Self { scaled: scaled.collect(), rays, sigmas })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// The slopes of each match in the first and the second camera, with a one below.
    pub fn rays(&self) -> &[RayPair] {
        &self.rays
    }
}

/// Why matches are none.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum MatchError {
    /// A pixel is not finite.
    #[error("match {at}: a coordinate of a pixel is not finite; leave the match out")]
    Pixel {
        /// Which match.
        at: usize,
    },
    /// The standard deviation is none.
    #[error("sigma is {sigma}; give a positive, finite number of pixels")]
    Sigma {
        /// What was given, in pixels.
        sigma: f64,
    },
    /// The intrinsics are none.
    #[error("camera {camera}: the intrinsics are not those of a camera; check its numbers")]
    Camera {
        /// 0 for the first, 1 for the second.
        camera: usize,
    },
}
