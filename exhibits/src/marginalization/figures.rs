//! The figures of the chapter.

mod precision;
mod sigmas;
mod slides;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("slides", slides::slides);
    chapter.figure("precision", precision::precision);
    chapter.figure("sigmas", sigmas::sigmas);
}
