//! What an approximation costs.

use nalgebra::RealField;

use super::pivots::factorize_blocks;
use super::{Information, MarginalizationError};

/// The Kullback-Leibler divergence D(p‖q) = E_p[ln p − ln q] in nats: what is lost when q stands for
/// p. It is not negative, zero for the same Gaussian alone, the same in every unit of the blocks, and
/// not symmetric.
///
/// Implements {eq:gaussian-divergence}.
///
/// # Errors
///
/// [`MarginalizationError::DifferentBlocks`], and [`MarginalizationError::Singular`] or
/// [`MarginalizationError::Indefinite`] when either leaves a direction free or is no Gaussian.
// ANCHOR: divergence
pub fn divergence<T: RealField + Copy>(
    p: &Information<T>,
    q: &Information<T>,
) -> Result<T, MarginalizationError> {
    if p.blocks() != q.blocks() {
        return Err(MarginalizationError::DifferentBlocks);
    }
    let known = factorize_blocks(p.matrix(), p.blocks())?;
    let kept = factorize_blocks(q.matrix(), q.blocks())?;
    // With Λ = L Lᵀ, the trace is the square of L_p⁻¹ L_q.
    let mut half = kept.l();
    known.l_dirty().solve_lower_triangular_unchecked_mut(&mut half);
    let moved = kept.solve(q.vector()) - known.solve(p.vector());
    let count: T = nalgebra::convert(p.blocks().dimension() as f64);
    let spread = half.norm_squared() - count + known.ln_determinant() - kept.ln_determinant();
    let one_half: T = nalgebra::convert(0.5);
    Ok(one_half * (spread + moved.dot(&(q.matrix() * &moved))))
}
// ANCHOR_END: divergence
