//! The figures of the chapter.

mod depth_error;
mod inverse_depth;
mod rays;
mod rotation_translation;
mod second_camera;

use crate::chapter::Chapter;

/// Registers the figures.
pub fn figures(chapter: &mut Chapter) {
    chapter.figure("rays", rays::rays);
    chapter.figure("second_camera", second_camera::second_camera);
    chapter.figure("rotation_translation", rotation_translation::rotation_translation);
    chapter.figure("inverse_depth", inverse_depth::inverse_depth);
    chapter.figure("depth_error", depth_error::depth_error);
}
