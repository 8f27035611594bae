//! Scale, velocity, bias and gravity in linear equations.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
