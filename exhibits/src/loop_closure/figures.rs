//! The figures of the chapter.

mod hall;
mod minima;
mod sphere;
mod steps;
mod tilt;
mod wrong;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("hall", hall::hall);
    chapter.figure("tilt", tilt::tilt);
    chapter.figure("sphere", sphere::sphere);
    chapter.figure("steps", steps::steps);
    chapter.figure("minima", minima::minima);
    chapter.figure("wrong", wrong::wrong);
}
