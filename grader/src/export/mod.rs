//! The repository that students get: exercises, their public checks and hints, and the library,
//! complete and working by itself. What students must not have is searched for before anything is
//! written.

mod leaks;
mod manifest;
mod sources;
mod tree;

use std::fs;
use std::path::Path;

pub use leaks::leaks;
pub use tree::{Tree, editions, every_skeleton, newest_skeleton, tree};

/// Writes the students' repository into a folder that is not there yet or empty, with the sources
/// of all dependencies when `vendor` says so.
///
/// # Errors
///
/// A sentence when the folder is not empty, something that students must not have would be in it,
/// or it cannot be written. Then the folder is as it was.
pub fn export(dir: &Path, vendor: bool) -> Result<(), String> {
    export_from(&crate::repository(), dir, vendor)?;
    let sources = if vendor { " with the sources of all dependencies" } else { "" };
    println!(
        "{} is a repository for students{sources}. Its README.md says how to begin; try it:",
        dir.display()
    );
    println!("cd {} && cargo run -p exercises", dir.display());
    Ok(())
}

/// [`export`] from a repository that is not the one the grader was compiled from.
///
/// # Errors
///
/// As [`export`].
pub fn export_from(root: &Path, dir: &Path, vendor: bool) -> Result<(), String> {
    let tree = tree(root, vendor)?;
    let found = leaks(root, &tree)?;
    if !found.is_empty() {
        return Err(format!(
            "nothing was exported, because students must not have this:\n{}",
            found.join("\n")
        ));
    }
    let existed = dir.exists();
    empty(dir)?;
    let written =
        write(&tree, dir).and_then(|()| sources::lock(root, dir)).and_then(|()| match vendor {
            true => sources::vendor(dir),
            false => Ok(()),
        });
    written.map_err(|error| match undo(dir, existed) {
        Ok(()) => error,
        Err(undoing) => format!("{error}\n{} could not be emptied again: {undoing}", dir.display()),
    })
}

/// Makes sure that the folder can be written to and loses nothing.
fn empty(dir: &Path) -> Result<(), String> {
    let cannot = |error| format!("cannot export to {}: {error}", dir.display());
    fs::create_dir_all(dir).map_err(cannot)?;
    match fs::read_dir(dir).map_err(cannot)?.next() {
        None => Ok(()),
        Some(_) => Err(format!(
            "{} is not empty; name a folder that is not there yet, so that nothing is lost",
            dir.display()
        )),
    }
}

fn write(tree: &Tree, dir: &Path) -> Result<(), String> {
    for (path, bytes) in tree {
        let path = dir.join(path);
        fs::create_dir_all(path.parent().unwrap_or(dir))
            .and_then(|()| fs::write(&path, bytes))
            .map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    Ok(())
}

/// Takes everything out of a folder that was empty, and the folder if it was not there.
fn undo(dir: &Path, existed: bool) -> std::io::Result<()> {
    if !existed {
        return fs::remove_dir_all(dir);
    }
    for entry in fs::read_dir(dir)? {
        let path = entry?.path();
        if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }?;
    }
    Ok(())
}
