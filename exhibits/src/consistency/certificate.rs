//! What a covariance claims along the free directions, through updates, transitions and forgetting.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
