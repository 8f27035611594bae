//! Numbers in sentences.

use crate::chapter::Chapter;

/// Registers the numbers.
pub fn numbers(_chapter: &mut Chapter) {}
