//! A body at rest: what tilt and bias say about each other.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
