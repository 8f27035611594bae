//! Copies of parts of the repository, to be changed.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

pub fn root() -> PathBuf {
    grader::repository()
}

/// Files and folders of the repository, at their places in a new one. What the build of the book
/// makes is left out.
pub fn copy(paths: &[&str]) -> TempDir {
    let copy = tempfile::tempdir().expect("a folder");
    for path in paths {
        copy_to(&root().join(path), &copy.path().join(path));
    }
    copy
}

/// A file, or a folder with all that is in it, to another place.
pub fn copy_to(from: &Path, to: &Path) {
    if ["src/api", "src/generated"].iter().any(|made| from == root().join(made)) {
        return;
    }
    if from.is_dir() {
        for entry in fs::read_dir(from).expect("a folder").flatten() {
            copy_to(&entry.path(), &to.join(entry.file_name()));
        }
    } else {
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        fs::copy(from, to).expect("copied");
    }
}
