//! What the prose quotes of the flights.

use crate::chapter::Chapter;

pub fn numbers(_chapter: &mut Chapter) {}
