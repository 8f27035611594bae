//! What a slide couples.

use std::collections::BTreeSet;

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
    let linked = |a: usize, b: usize| layout.odometry && a.abs_diff(b) == 1;
    let leaving = layout.seen_by.iter().filter(|seen_by| seen_by.contains(&departing));
    let mut met: BTreeSet<usize> = leaving.flatten().copied().collect();
    met.extend((0..layout.keyframes).filter(|other| linked(*other, departing)));
    met.remove(&departing);
    let pairs = met.iter().flat_map(|a| met.range(a + 1..).map(|b| (*a, *b)));
    pairs.filter(|(a, b)| !linked(*a, *b)).collect()
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
    let (a, b) = (size * link.0, size * link.1);
    let mut without = information.clone();
    without.view_mut((a, b), (size, size)).fill(0.0);
    without.view_mut((b, a), (size, size)).fill(0.0);
    let (with, left) = (information.cholesky()?, without.clone().cholesky()?);
    let excess = with.solve(&without).trace() - without.nrows() as f64;
    Some(0.5 * (excess + with.ln_determinant() - left.ln_determinant()))
}

/// The link that costs least, smaller index first: of all pairs whose block is not zero and
/// whose dropping leaves a Gaussian, the one of the least divergence. `None` when there is no
/// such pair.
pub fn cheapest_link(information: DMatrix<f64>, size: usize) -> Option<(usize, usize)> {
    let count = information.nrows() / size;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    let linked =
        |(a, b): &(usize, usize)| information.view((size * a, size * b), (size, size)).amax() > 0.0;
    pairs
        .filter(linked)
        .filter_map(|link| Some((link, information_lost(information.clone(), size, link)?)))
        .min_by(|(_, one), (_, other)| one.total_cmp(other))
        .map(|(link, _)| link)
}
