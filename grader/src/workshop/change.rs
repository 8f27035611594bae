//! Changes to a repository, all of them or none.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// A file that is made, or whose text is changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// Path in the repository, with `/` between folders.
    pub path: String,
    /// The text it has, or nothing when it is made.
    pub before: Option<String>,
    /// The text it gets.
    pub after: String,
}

/// Makes all changes. On an error those made before it are undone.
///
/// # Errors
///
/// A sentence when a file to be made is there already, one to be changed has another text by now,
/// or one cannot be written.
pub fn apply(root: &Path, changes: &[Change]) -> Result<(), String> {
    for change in changes {
        change.is_possible(root)?;
    }
    let mut made = Made::default();
    for (index, change) in changes.iter().enumerate() {
        if let Err(error) = made.make(root, change) {
            let sentence = format!("{} cannot be written: {error}", change.path);
            return Err(match made.undo(root, &changes[..index]) {
                Ok(()) => format!("{sentence}; nothing was changed"),
                Err(undoing) => {
                    format!("{sentence}; what was changed could not be undone: {undoing}")
                }
            });
        }
    }
    Ok(())
}

impl Change {
    fn is_possible(&self, root: &Path) -> Result<(), String> {
        let path = root.join(&self.path);
        match &self.before {
            None if path.symlink_metadata().is_ok() => {
                Err(format!("{} is there already; choose another name", self.path))
            }
            Some(before) if fs::read_to_string(&path).ok().as_ref() != Some(before) => {
                Err(format!("{} was changed meanwhile; try again", self.path))
            }
            _ => Ok(()),
        }
    }
}

/// What an application made so far.
#[derive(Default)]
struct Made {
    folders: Vec<PathBuf>,
}

impl Made {
    fn make(&mut self, root: &Path, change: &Change) -> io::Result<()> {
        let path = root.join(&change.path);
        if change.before.is_none() {
            self.folder(path.parent().unwrap_or(root))?;
        }
        replace(&path, &change.after)
    }

    /// Makes a folder and those above it, and remembers them.
    fn folder(&mut self, folder: &Path) -> io::Result<()> {
        if folder.is_dir() {
            return Ok(());
        }
        if let Some(above) = folder.parent() {
            self.folder(above)?;
        }
        fs::create_dir(folder)?;
        self.folders.push(folder.to_owned());
        Ok(())
    }

    fn undo(&self, root: &Path, changes: &[Change]) -> io::Result<()> {
        for change in changes {
            let path = root.join(&change.path);
            match &change.before {
                Some(before) => replace(&path, before)?,
                None => fs::remove_file(path)?,
            }
        }
        self.folders.iter().rev().try_for_each(fs::remove_dir)
    }
}

/// Writes beside the file and renames, so that there is the old text or the new one and never a
/// part.
fn replace(path: &Path, text: &str) -> io::Result<()> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    let mut file = fs::File::create_new(&beside)?;
    let written = file.write_all(text.as_bytes());
    drop(file);
    written.and_then(|()| fs::rename(&beside, path)).inspect_err(|_| drop(fs::remove_file(&beside)))
}
