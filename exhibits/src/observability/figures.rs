//! The figures of the chapter.

use crate::chapter::Chapter;

/// Registers the figures.
pub fn figures(_chapter: &mut Chapter) {}
