//! What chapter `preintegration` shows: many inertial readings as one measurement.

mod flights;
mod noise;
mod sums;

use crate::chapter::Chapter;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    sums::exhibits(chapter);
    noise::exhibits(chapter);
    flights::exhibits(chapter);
}
