//! The four free directions, carried through transitions, copies and pixels.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
