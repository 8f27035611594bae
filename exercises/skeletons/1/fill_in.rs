//! What a slide couples. Edition 1.
//!
//! `cargo test -p exercises fill_in`

use exercise_spec::fill_in::Layout;
use nalgebra::DMatrix;

/// The pairs of surviving keyframes that are coupled when the keyframe `departing` and the
/// landmarks it saw have been eliminated together, and were not before. Each pair once, the
/// smaller index first, in ascending order.
///
/// Two variables are coupled when their block of the information matrix is not zero.
/// Landmarks that the departing keyframe did not see stay in the window as variables of their
/// own, so they couple no keyframes with each other.
pub fn new_couplings(layout: Layout, departing: usize) -> Vec<(usize, usize)> {
    let _ = (layout, departing);
    todo!("who is joined by what leaves, less who was joined before")
}

/// What is lost, in nats, when the link of two keyframes is dropped: the Kullback-Leibler
/// divergence D(p‖q) = E_p[ln p − ln q]. p is the Gaussian with the information matrix given;
/// q has the same mean and the same matrix, in which both blocks of the link are zero. Each
/// keyframe has `size` rows. `None` when the matrix of q is not positive definite: then
/// there is no such Gaussian.
pub fn information_lost(
    information: DMatrix<f64>,
    size: usize,
    link: (usize, usize),
) -> Option<f64> {
    let _ = (information, size, link);
    todo!("the divergence of two Gaussians with the same mean")
}

/// The link that costs least, smaller index first: of all pairs whose block is not zero and
/// whose dropping leaves a Gaussian, the one of the least divergence. `None` when there is no
/// such pair.
pub fn cheapest_link(information: DMatrix<f64>, size: usize) -> Option<(usize, usize)> {
    let _ = (information, size);
    todo!("the least of all links by what is lost with it")
}
