//! Reading and writing, with errors that say what to do.

use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result};

/// Reads a text file.
pub fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

/// Reads a text file that may be absent.
pub fn read_if_there(path: &Path) -> Result<Option<String>> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("cannot read {}", path.display())),
    }
}

/// Writes a file and the folders above it. A file that already says the same is left alone, so that
/// nobody who watches it is woken.
pub fn write(path: &Path, content: &[u8]) -> Result<()> {
    if fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| unwritable(folder))?;
    }
    fs::write(path, content).with_context(|| unwritable(path))
}

/// Removes a file or a folder with all that is in it; it may be absent.
pub fn remove(path: &Path) -> Result<()> {
    let removed = match path.is_dir() {
        true => fs::remove_dir_all(path),
        false => fs::remove_file(path),
    };
    match removed {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| unwritable(path))
        }
        _ => Ok(()),
    }
}

/// Puts the folder `from` in the place of the folder `to`.
pub fn replace_folder(from: &Path, to: &Path) -> Result<()> {
    remove(to)?;
    fs::rename(from, to).with_context(|| unwritable(to))
}

/// The files below a folder, in order, as paths relative to it; none when the folder is absent.
pub fn below(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        let entries = match fs::read_dir(&next) {
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            entries => {
                entries.with_context(|| format!("cannot read the folder {}", next.display()))?
            }
        };
        for entry in entries {
            let path = entry?.path();
            match path.is_dir() {
                true => open.push(path),
                false => found.push(path.strip_prefix(folder).unwrap_or(&path).to_path_buf()),
            }
        }
    }
    found.sort();
    Ok(found)
}

fn unwritable(path: &Path) -> String {
    format!(
        "cannot write {}: make the folder writable, or copy the book to a folder that is",
        path.display()
    )
}

/// A path as it is written from a folder, both below one root; none when it leaves the root.
pub fn joined(folder: &Path, way: &str) -> Option<PathBuf> {
    let mut path = PathBuf::new();
    for part in folder.join(way).components() {
        match part {
            Component::ParentDir if !path.pop() => return None,
            Component::Normal(part) => path.push(part),
            Component::Prefix(_) | Component::RootDir => return None,
            Component::ParentDir | Component::CurDir => {}
        }
    }
    Some(path)
}
