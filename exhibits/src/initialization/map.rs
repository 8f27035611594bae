//! The most likely inertial unknowns of a shape.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
