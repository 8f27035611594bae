//! Errors in which the free directions are the same at every estimate.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
