//! What chapter `preintegration` shows: many inertial readings as one measurement.

mod noise;
pub mod oracle;
pub mod speed;
mod sums;

use crate::chapter::Chapter;
use crate::one_flight;

pub fn exhibits(chapter: &mut Chapter) {
    sums::exhibits(chapter);
    noise::exhibits(chapter);
    speed::exhibits(chapter);
    one_flight::readings::summed(chapter);
    one_flight::readings::spread(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    sums::cost::record(chapter);
    speed::record(chapter);
}
