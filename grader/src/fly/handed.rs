//! Where the files of an answer lie in what was handed in: in the folder itself, in the only one in it, or in
//! a ZIP file.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::answer::{COVARIANCE, DECLARATION, LARGEST, TEXT, TRAJECTORY, folder};
use super::flights::FLIGHTS;
use crate::archive::{Wanted, is_zip, unpacked};

/// So many folders may lie around an answer.
const DEEP: usize = 4;
/// What is taken out of a ZIP file.
const FILES: Wanted = Wanted {
    name: |name| [DECLARATION, TEXT, TRAJECTORY, COVARIANCE].contains(&name),
    largest: LARGEST,
    most: 4 * FLIGHTS,
};

/// The folder of an answer. What was unpacked for it goes with it.
#[derive(Debug)]
pub struct Handed {
    root: PathBuf,
    _unpacked: Option<TempDir>,
}

impl Handed {
    /// Finds it in a folder, or in a ZIP file or one in a folder without an answer.
    ///
    /// # Errors
    ///
    /// A sentence when a ZIP file cannot be unpacked.
    pub fn find(path: &Path) -> Result<Self, String> {
        let root = within(path);
        if has_answer(&root) {
            return Ok(Self { root, _unpacked: None });
        }
        let inside = entries(path).filter(|path| path.is_file() && is_zip(path));
        let Some(zip) = Some(path.to_owned()).filter(|path| is_zip(path)).or(inside.last()) else {
            return Ok(Self { root, _unpacked: None });
        };
        let folder = unpacked(&zip, &FILES)?.folder;
        Ok(Self { root: within(folder.path()), _unpacked: Some(folder) })
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }
}

/// Whether a folder has anything of an answer.
pub fn has_answer(root: &Path) -> bool {
    let is_there = |name: &str| fs::symlink_metadata(root.join(name)).is_ok();
    is_there(DECLARATION) || (0..FLIGHTS).any(|flight| is_there(&folder(flight)))
}

/// The folder with the answer: this one, or the one in it as long as there is no other.
fn within(path: &Path) -> PathBuf {
    let mut at = path.to_owned();
    for _ in 0..DEEP {
        if has_answer(&at) {
            return at;
        }
        let is_folder =
            |path: &PathBuf| fs::symlink_metadata(path).is_ok_and(|found| found.is_dir());
        let mut folders = entries(&at).filter(is_folder);
        let (Some(only), None) = (folders.next(), folders.next()) else { return at };
        at = only;
    }
    at
}

fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path())
}
