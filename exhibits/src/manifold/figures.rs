//! The figures of the chapter.

mod accuracy;
mod banana;
mod orders;
mod steps;

use crate::chapter::Chapter;

/// Registers the figures.
pub fn figures(chapter: &mut Chapter) {
    chapter.figure("orders", orders::orders);
    chapter.figure("steps", steps::steps);
    chapter.figure("banana", banana::banana);
    chapter.figure("accuracy", accuracy::accuracy);
}
