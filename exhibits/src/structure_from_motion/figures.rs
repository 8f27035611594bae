//! The figures of the chapter.

mod drift;
mod growth;
mod survival;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("survival", survival::survival);
    chapter.figure("growth", growth::growth);
    chapter.figure("drift", drift::drift);
}
