//! The factor and the kernel that other chapters define.

use nalgebra::Vector2;

/// One observation: a camera saw a point at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReprojFactor {
    /// Index of the camera.
    pub camera: usize,
    /// Index of the point.
    pub point: usize,
    /// Where the point was seen.
    pub pixel: Vector2<f64>,
    /// One over the standard deviation of a coordinate of the pixel, in 1/pixel.
    pub inv_sigma: f64,
}

/// Huber's cost of a whitened residual of length `s`: s²/2 up to the threshold and a
/// straight line beyond.
pub(crate) fn huber_cost(threshold: Option<f64>, squared: f64) -> f64 {
    match threshold {
        Some(threshold) if squared > threshold * threshold => {
            threshold * (squared.sqrt() - 0.5 * threshold)
        }
        _ => 0.5 * squared,
    }
}

/// The weight ρ'(s)/s of a squared residual.
pub(crate) fn huber_weight(threshold: Option<f64>, squared: f64) -> f64 {
    match threshold {
        Some(threshold) if squared > threshold * threshold => threshold / squared.sqrt(),
        _ => 1.0,
    }
}
