//! What chapter `factrs` shows: the graph of `examples/two_keyframes.rs`, how far off it is and why other libraries
//! differ from the book's. What factrs itself says is computed by the crate in the folder `factrs`, and recorded.

mod errors;
mod figures;
mod free;
mod gtsam;
mod lines;
mod tangent;

#[path = "../../factrs/src/predicted.rs"]
mod predicted;

#[allow(dead_code)]
#[path = "../../code/examples/two_keyframes.rs"]
pub mod two_keyframes;

use crate::chapter::Chapter;

pub fn exhibits(chapter: &mut Chapter) {
    tangent::exhibits(chapter);
    free::numbers(chapter);
    lines::numbers(chapter);
    errors::numbers(chapter);
    gtsam::numbers(chapter);
    figures::figures(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    errors::record(chapter);
    gtsam::record(chapter);
}
