//! What a slide couples: pairs that an elimination joins, and what it costs to part them again.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

/// Two keyframes, the smaller index first.
pub type Pair = (usize, usize);

// ANCHOR: layout
/// Who has measured whom in a window.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layout {
    /// How many keyframes there are.
    pub keyframes: usize,
    /// Whether odometry links each keyframe to the next. Without it nothing links two keyframes.
    pub odometry: bool,
    /// For each landmark the keyframes that see it, in ascending order.
    pub seen_by: Vec<Vec<usize>>,
}
// ANCHOR_END: layout

crate::signatures! {
    // ANCHOR: signatures
    /// The pairs of surviving keyframes that are coupled when the keyframe `departing` and the
    /// landmarks it saw have been eliminated together, and were not before. Each pair once, the
    /// smaller index first, in ascending order.
    ///
    /// Two variables are coupled when their block of the information matrix is not zero.
    /// Landmarks that the departing keyframe did not see stay in the window as variables of their
    /// own, so they couple no keyframes with each other.
    fn new_couplings(layout: Layout, departing: usize) -> Vec<(usize, usize)>;
    // ANCHOR_END: signatures

    // ANCHOR: dropping
    /// What is lost, in nats, when the link of two keyframes is dropped: the Kullback-Leibler
    /// divergence D(p‖q) = E_p[ln p − ln q]. p is the Gaussian with the information matrix given;
    /// q has the same mean and the same matrix, in which both blocks of the link are zero. Each
    /// keyframe has `size` rows. `None` when the matrix of q is not positive definite: then
    /// there is no such Gaussian.
    fn information_lost(
        information: DMatrix<f64>,
        size: usize,
        link: (usize, usize),
    ) -> Option<f64>;

    /// The link that costs least, smaller index first: of all pairs whose block is not zero and
    /// whose dropping leaves a Gaussian, the one of the least divergence. `None` when there is no
    /// such pair.
    fn cheapest_link(information: DMatrix<f64>, size: usize) -> Option<(usize, usize)>;
    // ANCHOR_END: dropping
}
