//! A rotation that turns on, and what comes of an error of the angular velocity.

use nalgebra::{Matrix3, Vector3};

use super::block::Block;
pub use crate::manifold::coefficients::Turn;
use crate::manifold::coefficients::turn;
use crate::manifold::so3::hat_polynomial;

// ANCHOR: turning
/// A rotation R before a turn by φ, and what is needed to multiply R by any polynomial in φ^.
/// There are only three powers, since φ^ φ^ φ^ = −|φ|² φ^.
pub struct Turning {
    powers: [Block; 3],
    /// R φ, which is φ seen from the first frame.
    axis: Vector3<f64>,
    /// The squared angle, and its coefficients.
    pub square: f64,
    pub turn: Turn,
}

impl Turning {
    #[inline(always)]
    pub fn new(rotation: &Block, phi: &Vector3<f64>) -> Self {
        let once = rotation.times_hat(phi);
        let square = phi.norm_squared();
        let powers = [*rotation, once, once.times_hat(phi)];
        Self { powers, axis: *rotation * *phi, square, turn: turn(square) }
    }

    /// R (I + a φ^ + b φ^ φ^).
    #[inline(always)]
    pub fn times(&self, a: f64, b: f64) -> Block {
        let [rotation, once, twice] = self.powers;
        rotation + a * once + b * twice
    }

    /// R (I + a φ^ + b φ^ φ^) Rᵀ, which takes no products: it is the polynomial in (R φ)^.
    #[inline(always)]
    pub fn moment(&self, a: f64, b: f64) -> Block {
        let m: Matrix3<f64> = hat_polynomial(&self.axis, a, b);
        Block::of(&m)
    }
}
// ANCHOR_END: turning
