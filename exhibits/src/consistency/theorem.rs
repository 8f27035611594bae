//! One linearization point for each variable: what it keeps, and what each condition is for.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
