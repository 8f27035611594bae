//! The figures of the chapter.

mod divergence;
mod lag;
mod nees;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("lag", lag::lag);
    chapter.figure("nees", nees::nees);
    chapter.figure("divergence", divergence::divergence);
}
