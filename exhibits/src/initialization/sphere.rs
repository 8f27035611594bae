//! A quadratic form on a sphere.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
