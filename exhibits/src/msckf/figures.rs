//! The figures of the chapter.

mod blocks;
mod cost;
mod flight;
mod hover;
mod nees;
mod rays;
mod step;
mod windows;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("rays", rays::rays);
    chapter.figure("blocks", blocks::blocks);
    chapter.figure("step", step::step);
    chapter.figure("flight", flight::flight);
    chapter.figure("nees", nees::nees);
    chapter.figure("cost", cost::cost);
    chapter.figure("windows", windows::windows);
    chapter.figure("hover", hover::hover);
}
