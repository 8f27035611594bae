//! The figures of the chapter.

mod lens;
mod mixed_iterations;
mod mixed_outcome;
mod pose_columns;
mod sensitivity;

use crate::chapter::Chapter;

/// Registers the figures.
pub fn figures(chapter: &mut Chapter) {
    chapter.figure("pose_columns", pose_columns::pose_columns);
    chapter.figure("sensitivity", sensitivity::sensitivity);
    chapter.figure("lens", lens::lens);
    chapter.figure("mixed_iterations", mixed_iterations::mixed_iterations);
    chapter.figure("mixed_outcome", mixed_outcome::mixed_outcome);
}
