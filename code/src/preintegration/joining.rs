//! Two intervals in a row as one.

use nalgebra::Matrix3;

use super::{CombinedPreintegrated, Deltas, Matrix9, Preintegrated, PreintegrationError};
use crate::manifold::so3;

impl Deltas {
    /// The deltas of this interval and of a later one that begins where this one ends and lasts
    /// `duration` seconds. Implements {eq:delta-composition}.
    pub fn then(&self, later: &Self, duration: f64) -> Self {
        let carried = self.position + duration * self.velocity;
        Self {
            rotation: self.rotation * later.rotation,
            velocity: self.velocity + self.rotation * later.velocity,
            position: carried + self.rotation * later.position,
        }
    }
}

impl Preintegrated {
    /// The sums over this interval and the later one that follows it, as if their readings had
    /// been summed at once: to rounding, by either rule and at any place to split.
    ///
    /// Errors of the later interval are relative to the end of this one. With deltas (R₁, v₁, p₁)
    /// and (R₂, v₂, p₂), and `t` the duration of the later interval, {eq:delta-composition} moves
    /// by e = F e₁ + G e₂ in the order (φ, v, p), where
    ///
    /// ```text
    ///     ⎡  R₂ᵀ     0    0 ⎤        ⎡ I  0   0  ⎤
    /// F = ⎢ −R₁ v₂^  I    0 ⎥    G = ⎢ 0  R₁  0  ⎥
    ///     ⎣ −R₁ p₂^  t I  I ⎦        ⎣ 0  0   R₁ ⎦
    /// ```
    ///
    /// The noise of the two is independent, so Σ = F Σ₁ Fᵀ + G Σ₂ Gᵀ, and the derivative by the
    /// bias, which is the same one, is J = F J₁ + G J₂.
    ///
    /// # Errors
    ///
    /// [`PreintegrationError::BiasesDiffer`] when the biases are not the same,
    /// [`PreintegrationError::Empty`] when one of the intervals has no step,
    /// [`PreintegrationError::Overflow`] when the sums are too large.
    pub fn then(&self, later: &Self) -> Result<Self, PreintegrationError> {
        if self.steps == 0 || later.steps == 0 {
            return Err(PreintegrationError::Empty);
        }
        if self.bias != later.bias {
            let (first, later) = (self.bias.vector().into(), later.bias.vector().into());
            return Err(PreintegrationError::BiasesDiffer { first, later });
        }
        let (f, g) = transport(&self.deltas, &later.deltas, later.duration);
        let covariance = f * self.covariance * f.transpose() + g * later.covariance * g.transpose();
        let joined = Self {
            duration: self.duration + later.duration,
            steps: self.steps + later.steps,
            deltas: self.deltas.then(&later.deltas, later.duration),
            covariance: 0.5 * (covariance + covariance.transpose()),
            bias_jacobian: f * self.bias_jacobian + g * later.bias_jacobian,
            bias: self.bias,
            greatest_force: self.greatest_force.max(later.greatest_force),
        };
        joined.checked()
    }
}

impl CombinedPreintegrated {
    /// The same for sums whose bias walks. The readings of the later interval are freed of the bias
    /// that this one begins with, so what its deltas lack depends on how far the bias has walked until
    /// then: r₂ becomes r₂ + J₂ w₁.
    ///
    /// # Errors
    ///
    /// As those of [`Preintegrated::then`].
    pub fn then(&self, later: &Self) -> Result<Self, PreintegrationError> {
        let mut sums = self.sums.then(&later.sums)?;
        let (f, g) = transport(&self.sums.deltas, &later.sums.deltas, later.sums.duration);
        let (with_bias, by_walk) = (f * self.with_bias, g * later.sums.bias_jacobian);
        let half = (with_bias + 0.5 * by_walk * self.walk) * by_walk.transpose();
        sums.covariance += half + half.transpose();
        let with_bias = with_bias + g * later.with_bias + by_walk * self.walk;
        Ok(Self { sums: sums.checked()?, with_bias, walk: self.walk + later.walk })
    }
}

/// The matrices F and G that take errors of two intervals to those of both in a row.
fn transport(first: &Deltas, later: &Deltas, duration: f64) -> (Matrix9, Matrix9) {
    let rotation = first.rotation.matrix();
    let mut f = Matrix9::identity();
    let mut put = |row, block: &Matrix3<f64>| {
        f.fixed_view_mut::<3, 3>(row, 0).copy_from(block);
    };
    put(0, &later.rotation.matrix().transpose());
    put(3, &(-rotation * so3::hat(&later.velocity)));
    put(6, &(-rotation * so3::hat(&later.position)));
    f.fixed_view_mut::<3, 3>(6, 3).fill_diagonal(duration);
    let mut g = Matrix9::identity();
    g.fixed_view_mut::<3, 3>(3, 3).copy_from(rotation);
    g.fixed_view_mut::<3, 3>(6, 6).copy_from(rotation);
    (f, g)
}
