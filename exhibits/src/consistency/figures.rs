//! The chapter's figures.

use crate::chapter::Chapter;

pub fn figures(_chapter: &mut Chapter) {}
