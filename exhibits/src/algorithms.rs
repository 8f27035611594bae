//! What chapter `algorithms` shows: what its algorithms cost, counted.

pub mod counted;
mod elimination;
mod growth;
mod limits;

use crate::chapter::Chapter;

pub fn exhibits(chapter: &mut Chapter) {
    elimination::exhibits(chapter);
    counted::numbers(chapter);
    growth::numbers(chapter);
    limits::numbers(chapter);
}
