//! The viewer as a web page needs it. It comes with a crate of rerun, so that its version and its checksum stand in
//! `Cargo.lock` as those of everything else.

use std::path::Path;

use re_web_viewer_server::{WebViewerData, WebViewerDataError};
use thiserror::Error;

/// Why there is no viewer for a page.
#[derive(Debug, Error)]
pub enum WebError {
    /// The crate does not hold it.
    #[error("rerun's crate has no web viewer: {0}")]
    Absent(#[from] WebViewerDataError),
    /// A file cannot be written.
    #[error("{file} cannot be written: {why}; name a folder that is writable")]
    File {
        /// Its path.
        file: String,
        /// What the system says.
        why: std::io::Error,
    },
}

/// Writes the viewer into a folder: `re_viewer.js`, and `re_viewer_bg.wasm` that it runs.
///
/// # Errors
///
/// A [`WebError`].
pub fn write_viewer(folder: &Path) -> Result<(), WebError> {
    let viewer = WebViewerData::load(None)?;
    for (name, content) in
        [("re_viewer.js", viewer.viewer_js()), ("re_viewer_bg.wasm", viewer.viewer_wasm())]
    {
        let file = folder.join(name);
        std::fs::write(&file, content)
            .map_err(|why| WebError::File { file: file.display().to_string(), why })?;
    }
    Ok(())
}
