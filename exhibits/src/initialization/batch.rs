//! The batch: what is fixed in it, and how sure it is of scale.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
