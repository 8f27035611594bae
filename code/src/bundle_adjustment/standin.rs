//! The factor and the kernel as the chapters before define them.

use nalgebra::Vector2;

/// One observation: a keyframe's camera saw a point at a pixel.
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

/// The cost ρ of a whitened residual as a function of its norm s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// ½ s² up to the threshold, a straight line beyond it.
    Huber(f64),
}

impl Kernel {
    /// The cost ρ(s).
    #[inline]
    pub fn cost(&self, norm: f64) -> f64 {
        match *self {
            Self::Huber(threshold) if norm > threshold => threshold * (norm - 0.5 * threshold),
            Self::Huber(_) => 0.5 * norm * norm,
        }
    }

    /// The weight ρ'(s)/s, by which the residual enters the normal equations.
    #[inline]
    pub fn weight(&self, norm: f64) -> f64 {
        match *self {
            Self::Huber(threshold) if norm > threshold => threshold / norm,
            Self::Huber(_) => 1.0,
        }
    }
}
