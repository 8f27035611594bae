//! Simulated flights, many of them.

use crate::chapter::Chapter;

pub fn numbers(_chapter: &mut Chapter) {}

pub fn record(_chapter: &mut Chapter) {}
