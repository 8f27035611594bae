//! A rotation that turns on, and what comes of an error of the angular velocity.

use nalgebra::Vector3;

use super::block::Block;
pub use crate::manifold::coefficients::Turn;
use crate::manifold::coefficients::turn;

// ANCHOR: turning
/// A rotation R that turns by φ: what is needed to multiply R by any polynomial in φ^. Of three
/// terms, since φ^ φ^ φ^ = −|φ|² φ^.
pub struct Turning {
    /// R, R φ^ and R φ^ φ^.
    powers: [Block; 3],
    /// w^ and w^ w^ of the vector w = R φ, which is φ seen from the first frame.
    moments: [Block; 2],
    /// The squared angle.
    pub square: f64,
    /// The coefficients of exp(φ) and its Jacobians.
    pub coefficients: Turn,
}
// ANCHOR_END: turning

impl Turning {
    #[inline(always)]
    pub fn new(rotation: &Block, phi: &Vector3<f64>) -> Self {
        let once = rotation.times_hat(phi);
        let powers = [*rotation, once, once.times_hat(phi)];
        let axis = *rotation * *phi;
        let moments = [Block::hat(&axis), Block::hat(&axis).times_hat(&axis)];
        let square = phi.norm_squared();
        Self { powers, moments, square, coefficients: turn(square) }
    }

    // ANCHOR: polynomials
    /// R (I + a φ^ + b φ^ φ^).
    #[inline(always)]
    pub fn times(&self, a: f64, b: f64) -> Block {
        let [rotation, once, twice] = self.powers;
        rotation + a * once + b * twice
    }

    /// R (I + b φ^ φ^) Rᵀ times a variance, which is the same polynomial in w^.
    #[inline(always)]
    pub fn moment(&self, variance: f64, b: f64) -> Block {
        Block::diagonal(variance) + (variance * b) * self.moments[1]
    }

    /// R φ^ Rᵀ times a number, which is w^ times that.
    #[inline(always)]
    pub fn skew(&self, number: f64) -> Block {
        number * self.moments[0]
    }
    // ANCHOR_END: polynomials
}
