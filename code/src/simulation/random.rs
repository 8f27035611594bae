//! Random numbers of a flight.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// What random numbers are for. Each purpose has a sequence of its own, so that what is switched on
/// for one of them does not change the others.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    Readings,
    Biases,
    Pixels,
    Outliers,
    Landmarks,
    Window,
}

/// The sequence of a seed for one purpose.
pub(crate) fn random(seed: u64, purpose: Purpose) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(purpose as u64);
    random
}

/// A number with mean zero and variance one.
pub(crate) fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}
