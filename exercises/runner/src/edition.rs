//! Skeletons: those that were handed out, and how an answer moves to a newer one.
//!
//! The first line of a skeleton ends in its edition. All editions stay in `skeletons`, so that
//! what a student has changed is known for ever.

use std::fs;
use std::iter;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::folder::{Folder, read, write};

/// What became of an answer that was brought to the newest edition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Update {
    /// It is of the newest edition already.
    Current(u32),
    /// The answer was merged into the newer skeleton; the former file is kept.
    Merged {
        /// The edition it is of now.
        edition: u32,
        /// Where the former answer lies.
        former: PathBuf,
    },
    /// Both changed the same lines. The answer stays as it was.
    Conflict {
        /// The edition it could not be brought to.
        edition: u32,
        /// Where the merged text lies, with the lines of both.
        merged: PathBuf,
    },
}

/// The edition an answer says it is of, in its first line: `Edition 1.`
pub fn edition_of(answer: &str) -> Option<u32> {
    let (_, rest) = answer.lines().next()?.split_once("Edition ")?;
    rest.trim().trim_end_matches('.').parse().ok()
}

/// The newest edition that has a skeleton of this name.
///
/// # Errors
///
/// When there is none.
pub fn newest(folder: &Folder, slug: &str) -> Result<u32, String> {
    let skeletons = folder.path().join("skeletons");
    let entries = fs::read_dir(&skeletons)
        .map_err(|error| format!("cannot read {}: {error}", skeletons.display()))?;
    let numbers = entries.flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let holds = |edition: &u32| folder.skeletons(*edition).join(format!("{slug}.rs")).is_file();
    numbers
        .filter(holds)
        .max()
        .ok_or_else(|| format!("there is no skeleton of `{slug}` in {}", skeletons.display()))
}

/// The skeleton of an edition. Between editions in which a skeleton changed it has no file.
fn skeleton(folder: &Folder, slug: &str, edition: u32) -> Result<String, String> {
    let file = |edition: u32| folder.skeletons(edition).join(format!("{slug}.rs"));
    match (1..=edition).rev().map(file).find(|path| path.is_file()) {
        Some(path) => read(&path),
        None => Err(format!("there is no skeleton of `{slug}` of edition {edition}")),
    }
}

/// The skeleton that an answer began with.
pub fn skeleton_of(folder: &Folder, slug: &str, answer: &str) -> Option<String> {
    skeleton(folder, slug, edition_of(answer)?).ok()
}

/// Puts the newest skeleton in place of an answer and tells where the former answer lies, if
/// there was anything but that skeleton. Pictures of the former answer go.
///
/// # Errors
///
/// When a file cannot be read or written; then nothing is lost.
pub fn reset(folder: &Folder, slug: &str) -> Result<Option<PathBuf>, String> {
    let fresh = skeleton(folder, slug, newest(folder, slug)?)?;
    folder.without_pictures(slug);
    if !folder.answer(slug).exists() {
        write(&folder.answer(slug), &fresh)?;
        return Ok(None);
    }
    if read(&folder.answer(slug)).as_ref() == Ok(&fresh) {
        return Ok(None);
    }
    let former = save(folder, slug)?;
    write(&folder.answer(slug), &fresh)?;
    Ok(Some(former))
}

/// Brings an answer to the newest edition of its skeleton, by a merge of what the student and
/// what the edition changed.
///
/// # Errors
///
/// When a file cannot be read or written, or the answer does not say its edition.
pub fn update(folder: &Folder, slug: &str) -> Result<Update, String> {
    let path = folder.answer(slug);
    let answer = read(&path)?;
    let newest = newest(folder, slug)?;
    let edition = edition_of(&answer).ok_or_else(|| {
        format!(
            "{}: the first line does not end in an edition; end it in `Edition N.`, with the \
             number of the skeleton you began with",
            path.display()
        )
    })?;
    if edition >= newest {
        return Ok(Update::Current(edition));
    }
    let (before, after) = (skeleton(folder, slug, edition)?, skeleton(folder, slug, newest)?);
    match diffy::merge(&before, &answer, &after) {
        Ok(merged) => {
            let former = save(folder, slug)?;
            write(&path, &merged)?;
            Ok(Update::Merged { edition: newest, former })
        }
        Err(conflict) => {
            // What a student has settled in a file of before is kept.
            let is_free = |name: &String| {
                let path = folder.kept(name);
                !path.exists() || read(&path).as_ref() == Ok(&conflict)
            };
            let plain = format!("{slug}.edition-{newest}.rs");
            let numbered = (2..).map(|count| format!("{slug}.edition-{newest}-{count}.rs"));
            let name = iter::once(plain).chain(numbered).find(is_free).unwrap_or_default();
            let merged = folder.keep(&name, &conflict).map_err(|error| error.to_string())?;
            Ok(Update::Conflict { edition: newest, merged })
        }
    }
}

/// Keeps a copy of an answer.
fn save(folder: &Folder, slug: &str) -> Result<PathBuf, String> {
    let answer = read(&folder.answer(slug))?;
    let elapsed = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let mut name = format!("former/{slug}-{}.rs", elapsed.as_secs());
    // Two in one second keep both.
    let mut count = 1;
    while folder.kept(&name).exists() {
        count += 1;
        name = format!("former/{slug}-{}-{count}.rs", elapsed.as_secs());
    }
    folder.keep(&name, &answer).map_err(|error| format!("cannot keep the former answer: {error}"))
}
