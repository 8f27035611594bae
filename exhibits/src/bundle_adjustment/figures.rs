//! The figures of the chapter.

mod consistency;
mod gauge;
mod growth;
mod outliers;
mod stereo;

use crate::chapter::Chapter;

/// Registers the figures of the second half.
pub fn second_half(chapter: &mut Chapter) {
    chapter.figure("gauge", gauge::gauge);
    chapter.figure("stereo", stereo::stereo);
    chapter.figure("consistency", consistency::consistency);
    chapter.figure("outliers", outliers::outliers);
    chapter.figure("growth", growth::growth);
}
