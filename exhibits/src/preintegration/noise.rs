//! How errors of the deltas arise, what their covariance is, and how it grows.

pub mod blocks;
mod correlated;
mod covariance;
mod dynamics;
mod figures;
mod growth;
mod oracle;
mod products;
mod runs;

use crate::chapter::Chapter;

/// Registers equations, numbers and figures.
pub fn exhibits(chapter: &mut Chapter) {
    dynamics::equations(chapter);
    covariance::equations(chapter);
    covariance::numbers(chapter);
    products::numbers(chapter);
    runs::numbers(chapter);
    growth::equations(chapter);
    growth::numbers(chapter);
    blocks::equations(chapter);
    blocks::numbers(chapter);
    correlated::equations(chapter);
    correlated::numbers(chapter);
    figures::figures(chapter);
}
