//! The figures of the chapter.

mod fence;
mod kernels;
mod posts;
mod rate;
mod two_minima;

use crate::chapter::Chapter;

/// Registers the figures.
pub fn figures(chapter: &mut Chapter) {
    chapter.figure("posts", posts::posts);
    chapter.figure("rate", rate::rate);
    chapter.figure("fence", fence::fence_figure);
    chapter.figure("two_minima", two_minima::two_minima);
    chapter.figure("kernels", kernels::kernels);
}
