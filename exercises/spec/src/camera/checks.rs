//! Cameras, and what they see, for checks.

use nalgebra::Vector3;

use super::Camera;
use crate::draw::Draw;

impl Camera {
    /// The camera of the book's worked examples.
    pub fn of_the_book() -> Self {
        Self { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 }
    }

    /// A camera whose two focal lengths differ, so that exchanging them is noticed.
    pub fn drawn(draw: &mut Draw) -> Self {
        let fx = draw.uniform(250.0..900.0);
        let fy = fx * draw.uniform(1.05..1.3);
        Self { fx, fy, cx: draw.uniform(250.0..700.0), cy: draw.uniform(150.0..500.0) }
    }
}

/// A point in camera coordinates between two depths in metres, up to 45 degrees off the axis.
pub fn point_in_view(draw: &mut Draw, nearest: f64, farthest: f64) -> Vector3<f64> {
    let depth = draw.uniform(nearest..farthest);
    depth * Vector3::new(draw.uniform(-0.7..0.7), draw.uniform(-0.7..0.7), 1.0)
}
