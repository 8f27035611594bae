//! The numbers that the chapter quotes.

use crate::chapter::Chapter;

/// Registers the numbers.
pub fn numbers(_chapter: &mut Chapter) {}
