//! What chapter `smoother` shows: what waiting is worth, when filter, smoother and batch are one estimate, and by how
//! much they are not.

mod anchored;
pub mod consistency;
pub mod divergence;
mod figures;
pub mod followed;
mod lag;
mod orders;
mod rounding;
mod variants;

use crate::chapter::Chapter;
use crate::one_flight;

pub fn exhibits(chapter: &mut Chapter) {
    lag::exhibits(chapter);
    anchored::exhibits(chapter);
    orders::counterexamples(chapter);
    variants::numbers(chapter);
    rounding::numbers(chapter);
    consistency::numbers(chapter);
    divergence::numbers(chapter);
    figures::figures(chapter);
    one_flight::followed::waited(chapter);
}

pub fn records(chapter: &mut Chapter) {
    consistency::record(chapter);
    divergence::record(chapter);
    variants::record(chapter);
}
