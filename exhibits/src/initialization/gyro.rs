//! The gyroscope's bias from turns that the pictures know.

use crate::chapter::Chapter;

pub fn exhibits(_chapter: &mut Chapter) {}
