//! What noise leaves of the linear equations.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
