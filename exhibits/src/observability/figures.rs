//! The figures of the chapter.

mod copies;
mod excitation;
mod false_scale;
mod spectra;
mod yaw;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("copies", copies::copies);
    chapter.figure("spectra", spectra::spectra);
    chapter.figure("false_scale", false_scale::false_scale);
    chapter.figure("excitation", excitation::excitation);
    chapter.figure("yaw", yaw::yaw);
}
