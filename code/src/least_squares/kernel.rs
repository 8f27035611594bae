//! How much a residual of a given size should count.

use thiserror::Error;

/// The cost ρ of a whitened residual as a function of its norm s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// ½ s²: the noise is normal.
    Squared,
    /// ½ s² up to the threshold, a straight line beyond it.
    Huber(f64),
    /// ½ c² ln(1 + s²/c²), with the scale c.
    Cauchy(f64),
}

// ANCHOR: kernel
impl Kernel {
    /// The cost ρ(s). Implements {eq:huber-shift} and {eq:student-noise}.
    pub fn cost(&self, norm: f64) -> f64 {
        match *self {
            Self::Huber(threshold) if norm > threshold => threshold * (norm - 0.5 * threshold),
            Self::Squared | Self::Huber(_) => 0.5 * norm * norm,
            Self::Cauchy(scale) => 0.5 * scale * scale * (norm / scale).powi(2).ln_1p(),
        }
    }

    /// The weight ρ'(s)/s, by which the residual enters the normal equations. Implements
    /// {eq:kernel-weight}.
    pub fn weight(&self, norm: f64) -> f64 {
        match *self {
            Self::Huber(threshold) if norm > threshold => threshold / norm,
            Self::Squared | Self::Huber(_) => 1.0,
            Self::Cauchy(scale) => 1.0 / (1.0 + (norm / scale).powi(2)),
        }
    }
}
// ANCHOR_END: kernel

// ANCHOR: beyond
/// Most residuals lie within the threshold. What the others need is kept apart, or the
/// processor would compute root and quotient for all of them before it chooses.
impl Kernel {
    /// The cost of a residual, from its squared norm.
    #[inline(always)]
    pub(super) fn cost_of_square(&self, squared: f64) -> f64 {
        if self.is_square(squared) { 0.5 * squared } else { self.cost_beyond(squared) }
    }

    /// The root of the weight of a residual, from its squared norm.
    #[inline(always)]
    pub(super) fn root_weight_of_square(&self, squared: f64) -> f64 {
        if self.is_square(squared) { 1.0 } else { self.root_weight_beyond(squared) }
    }

    #[cold]
    fn cost_beyond(&self, squared: f64) -> f64 {
        self.cost(squared.sqrt())
    }

    #[cold]
    fn root_weight_beyond(&self, squared: f64) -> f64 {
        self.weight(squared.sqrt()).sqrt()
    }
}
// ANCHOR_END: beyond

impl Kernel {
    /// Whether a residual counts as its square.
    #[inline(always)]
    fn is_square(&self, squared: f64) -> bool {
        match *self {
            Self::Squared => true,
            Self::Huber(threshold) => squared <= threshold * threshold,
            Self::Cauchy(_) => false,
        }
    }

    /// The influence ρ'(s): how hard a residual of this norm pulls.
    pub fn influence(&self, norm: f64) -> f64 {
        self.weight(norm) * norm
    }

    /// Whether its parameter makes it a kernel.
    pub(super) fn check(&self) -> Result<(), KernelError> {
        match *self {
            Self::Squared => Ok(()),
            Self::Huber(value) | Self::Cauchy(value) if value > 0.0 && value.is_finite() => Ok(()),
            Self::Huber(value) => Err(KernelError { name: "Huber threshold", value }),
            Self::Cauchy(value) => Err(KernelError { name: "Cauchy scale", value }),
        }
    }
}

/// A kernel's parameter is zero, negative or not finite.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{name} is {value}; give a positive, finite number of standard deviations")]
pub struct KernelError {
    /// Which parameter.
    pub name: &'static str,
    /// The value given.
    pub value: f64,
}
