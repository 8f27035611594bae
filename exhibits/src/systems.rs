//! What chapter `systems` shows: two systems block by block, and how many unknowns the windows of four have.

mod blocks;
mod sizes;

use crate::chapter::Chapter;

pub fn exhibits(chapter: &mut Chapter) {
    blocks::figures(chapter);
    sizes::numbers(chapter);
}
