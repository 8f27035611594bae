//! The batch of a real flight beside GTSAM.

use crate::chapter::Chapter;

pub fn numbers(_chapter: &mut Chapter) {}

pub fn record(_chapter: &mut Chapter) {}
