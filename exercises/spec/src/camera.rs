//! A camera as plain data.

use serde::{Deserialize, Serialize};
use vislam::reprojection::Pinhole;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::point_in_view;

// ANCHOR: camera
/// A pinhole camera, in pixels. `camera.pinhole()` is the library's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Focal length across.
    pub fx: f64,
    /// Focal length down.
    pub fy: f64,
    /// Column of the principal point.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
}
// ANCHOR_END: camera

impl Camera {
    /// The library's camera with these numbers.
    pub fn pinhole(&self) -> Pinhole {
        let Self { fx, fy, cx, cy } = *self;
        Pinhole { fx, fy, cx, cy }
    }
}
