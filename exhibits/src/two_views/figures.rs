//! The figures of the chapter.

mod clouds;
mod depth_bias;
mod depth_cloud;
mod epipolar;
mod five_solutions;
mod parallax;

pub use clouds::NINETY_FIVE;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("epipolar", epipolar::epipolar);
    chapter.figure("five_solutions", five_solutions::five_solutions);
    chapter.figure("clouds", clouds::clouds);
    chapter.figure("parallax", parallax::parallax);
    chapter.figure("depth_cloud", depth_cloud::depth_cloud);
    chapter.figure("depth_bias", depth_bias::depth_bias);
}
