//! What chapter `preintegration` shows.

mod flights;

use crate::chapter::Chapter;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    flights::exhibits(chapter);
}
