//! The figures of the chapter.
use crate::chapter::Chapter;
pub fn figures(_chapter: &mut Chapter) {}
