//! The same on flights whose truth is known, computed for each build.

use crate::chapter::Chapter;

pub fn numbers(_chapter: &mut Chapter) {}
