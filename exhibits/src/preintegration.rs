//! What chapter `preintegration` shows: hundreds of readings as one measurement.

mod noise;

use crate::chapter::Chapter;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    noise::exhibits(chapter);
}
