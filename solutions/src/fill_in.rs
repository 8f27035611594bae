//! What a slide couples.

use std::collections::BTreeSet;

use exercise_spec::fill_in::Layout;
use nalgebra::DMatrix;

/// The pairs of surviving keyframes that are coupled when the departing one and the landmarks it
/// saw have been eliminated together, and were not before. In ascending order.
pub fn new_couplings(layout: Layout, departing: usize) -> Vec<(usize, usize)> {
    let linked = |a: usize, b: usize| layout.odometry && a.abs_diff(b) == 1;
    let leaving = layout.seen_by.iter().filter(|seen_by| seen_by.contains(&departing));
    let mut met: BTreeSet<usize> = leaving.flatten().copied().collect();
    met.extend((0..layout.keyframes).filter(|other| linked(*other, departing)));
    met.remove(&departing);
    let pairs = met.iter().flat_map(|a| met.range(a + 1..).map(|b| (*a, *b)));
    pairs.filter(|(a, b)| !linked(*a, *b)).collect()
}

/// What is lost, in nats, when the link of two keyframes is dropped: D(p‖q), p with the link and q
/// without it. `None` when there is no Gaussian without it.
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

/// The link that costs least, smaller index first, or `None` when none can be dropped.
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
