//! How errors of the deltas arise, what their covariance is, and how it grows.

pub mod blocks;
mod correlated;
mod covariance;
pub mod dynamics;
mod figures;
mod growth;
pub mod oracle;
mod products;
mod runs;

use crate::chapter::Chapter;

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
