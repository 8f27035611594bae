//! Real flights: how far preintegrated readings are from the ground truth, and why.

mod budget;
mod equations;
mod figures;
mod intervals;
mod live;
mod record;
mod simulated;
mod speed;
mod wander;

use crate::chapter::Chapter;

/// Registers equations, numbers, figures and records.
pub fn exhibits(chapter: &mut Chapter) {
    equations::equations(chapter);
    live::numbers(chapter);
    record::records(chapter);
    speed::records(chapter);
    figures::figures(chapter);
}
