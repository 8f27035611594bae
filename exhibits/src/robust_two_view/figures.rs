//! The figures of the chapter.

mod agree;
mod shares;
mod success;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("success", success::success);
    chapter.figure("shares", shares::shares);
    chapter.figure("agree", agree::agree);
}
