//! What the chapter's theorems say falsely where one of their conditions is dropped.

use nalgebra::Vector2;
use vislam::reprojection::RadialTangential;

/// A lens whose Jacobian is positive definite on a disc and on all that lies outside of a larger
/// one, a set with a hole.
const K1: f64 = -0.6;
const K2: f64 = 0.13;

/// Two radii where that Jacobian is positive definite, the second given, and one shown radius.
pub struct ShownTogether {
    pub inner: f64,
    pub outer: f64,
    pub shown: f64,
    /// The smallest eigenvalue of the Jacobian at the two points.
    pub smallest: f64,
}

/// The inner radius that is shown where an outer one is, with the hole between them.
pub fn shown_together() -> ShownTogether {
    let lens = RadialTangential::new(K1, K2, 0.0, 0.0, 0.0).expect("finite coefficients");
    let outer = Vector2::new(1.45, 0.0);
    let shown = lens.distort(&outer);
    let inner = lens.undistort(&shown).unwrap_or(Vector2::repeat(f64::NAN));
    let smallest = |at: &Vector2<f64>| lens.jacobian(at).symmetric_eigenvalues().min();
    let smallest = smallest(&inner).min(smallest(&outer));
    ShownTogether { inner: inner.x, outer: outer.x, shown: shown.x, smallest }
}
