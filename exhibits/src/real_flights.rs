//! What chapter `real_flights` shows: how far preintegrated readings are from a ground truth, and why.

pub mod budget;
mod equations;
mod figures;
mod intervals;
mod live;
mod record;
pub mod simulated;
pub mod wander;

use crate::chapter::Chapter;

pub fn exhibits(chapter: &mut Chapter) {
    equations::equations(chapter);
    live::numbers(chapter);
    figures::figures(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    record::records(chapter);
}
