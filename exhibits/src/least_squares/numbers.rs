//! The numbers that the chapter quotes.
use crate::chapter::Chapter;
pub fn numbers(_chapter: &mut Chapter) {}
