//! The chapter's figures.

mod certificate;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("certificate", certificate::certificate);
}
