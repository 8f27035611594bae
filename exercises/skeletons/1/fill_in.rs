//! What a slide couples. Edition 1.
//!
//! `cargo test -p exercises fill_in`

use exercise_spec::fill_in::Layout;
use nalgebra::DMatrix;

/// The pairs of surviving keyframes that are coupled when the departing one and the landmarks it
/// saw have been eliminated together, and were not before. In ascending order.
pub fn new_couplings(layout: Layout, departing: usize) -> Vec<(usize, usize)> {
    let _ = (layout, departing);
    todo!("who is joined by what leaves, less who was joined before")
}

/// What is lost, in nats, when the link of two keyframes is dropped: D(p‖q), p with the link and q
/// without it. `None` when there is no Gaussian without it.
pub fn information_lost(
    information: DMatrix<f64>,
    size: usize,
    link: (usize, usize),
) -> Option<f64> {
    let _ = (information, size, link);
    todo!("the divergence of two Gaussians with the same mean")
}

/// The link that costs least, smaller index first, or `None` when none can be dropped.
pub fn cheapest_link(information: DMatrix<f64>, size: usize) -> Option<(usize, usize)> {
    let _ = (information, size);
    todo!("the least of all links by what is lost with it")
}
