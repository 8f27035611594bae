//! The figures of the chapter.

mod errors;
mod flight;
mod path;
mod switches;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("flight", flight::flight);
    chapter.figure("switches", switches::switches);
    chapter.figure("path", path::path);
    chapter.figure("errors", errors::errors);
}
