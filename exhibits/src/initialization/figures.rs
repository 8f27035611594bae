//! The figures of the chapter.

mod batch;
mod confused;
mod minima;
mod rotors;
mod scale;
mod seconds;
mod shrunk;
mod spectrum;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    confused::numbers(chapter);
    chapter.figure("confused", confused::confused);
    chapter.figure("rotors", rotors::rotors);
    chapter.figure("spectrum", spectrum::spectrum);
    chapter.figure("minima", minima::minima);
    chapter.figure("seconds", seconds::seconds);
    chapter.figure("scale", scale::scale);
    chapter.figure("batch", batch::batch);
    chapter.figure("shrunk", shrunk::shrunk);
}
