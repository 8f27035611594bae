//! ZIP files that students hand in, unpacked without trusting a word in them.
//!
//! Of the names in an archive only those lead anywhere that stay below the folder; of the files only
//! those are written that a submission may consist of, and no more of each than is read anyway; links
//! are none of them. Sizes that the archive states do not matter.

use std::fs::{self, File};
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;

use tempfile::TempDir;
use zip::ZipArchive;
use zip::result::ZipError;

use crate::submission::is_archive;
use crate::text::harmless_line;

/// The largest archive that is opened, in bytes.
const ARCHIVE: u64 = 500_000_000;
/// As many files as it may hold. An exercises folder with all of its dependencies has a third.
const FILES: u64 = 60_000;
/// How deep these may lie.
const DEEP: usize = 12;
/// What begins the entry of a file in an archive's list.
const ENTRY: &[u8] = b"PK\x01\x02";
/// What begins the end of a list that may be longer than 65,535 entries.
const LIST_END: &[u8] = b"PK\x06\x06";
/// Where that end states their number.
const STATED: Range<usize> = 24..32;
/// What ends any list: one of the archive, one of each archive in it, and behind each the list is looked for anew.
const END: &[u8] = b"PK\x05\x06";
/// As many lists as may end.
const ENDS: u64 = 32;

/// What is taken out of an archive.
#[derive(Debug, Clone, Copy)]
pub struct Wanted {
    /// Whether a file of this name is.
    pub name: fn(&str) -> bool,
    /// As much of each as is read, in bytes.
    pub largest: u64,
    /// As many as are.
    pub most: usize,
}

/// The files of an archive that may be answers, in a folder that goes with it.
#[derive(Debug)]
pub struct Unpacked {
    /// Where they lie.
    pub folder: TempDir,
    /// What was left in the archive and why.
    pub notices: Vec<String>,
    /// An archive in the archive, which nobody has looked into.
    pub inner: Option<String>,
}

/// Whether a file is called as a ZIP file.
pub fn is_zip(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("zip"))
}

/// Takes out of an archive what may be answers.
///
/// # Errors
///
/// A sentence when it cannot be read, or is too large to be looked at.
pub fn unpacked(path: &Path, wanted: &Wanted) -> Result<Unpacked, String> {
    let name = harmless_line(&path.file_name().unwrap_or_default().to_string_lossy(), 60);
    let told = |why: String| {
        format!(
            "`{name}` {why}; ask for a ZIP file of the answers alone, of exercises without `target` and `vendor`"
        )
    };
    let unreadable = |error: &dyn std::fmt::Display| {
        let error = harmless_line(&error.to_string(), 200);
        told(format!("is an archive that cannot be unpacked ({error})"))
    };
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    let size = file.metadata().map_err(|error| unreadable(&error))?.len();
    if size > ARCHIVE {
        return Err(told(format!("has {size} bytes and may have {ARCHIVE}")));
    }
    // The list is read as a whole, so it is counted before.
    let (files, ends) = counted(&file).map_err(|error| unreadable(&error))?;
    if files > FILES {
        return Err(told(format!("holds more than {FILES} files")));
    }
    if ends > ENDS {
        return Err(told(format!("holds more than {ENDS} archives")));
    }
    let mut archive = ZipArchive::new(file).map_err(|error| unreadable(&error))?;
    let folder = tempfile::tempdir().map_err(|error| unreadable(&error))?;
    let mut notices = Vec::new();
    let (mut taken, mut inner) = (0, None);
    for index in 0..archive.len() {
        let name = archive.name_for_index(index).unwrap_or_default();
        if is_archive(Path::new(name)) {
            inner.get_or_insert_with(|| harmless_line(name, 60));
        }
        if !(wanted.name)(last(name)) {
            continue;
        }
        let why_not = one(&mut archive, index, (folder.path(), wanted), &mut taken);
        notices.extend(why_not.map_err(|error| unreadable(&error))?);
    }
    notices.truncate(4);
    Ok(Unpacked { folder, notices, inner })
}

/// How many entries an archive can have, or says that it has: room for those is made before they are looked for. And how
/// often a list ends.
fn counted(mut file: &File) -> io::Result<(u64, u64)> {
    let mut buffer = vec![0; 1 << 20];
    let (mut kept, mut count, mut stated, mut ends) = (0, 0, 0, 0);
    loop {
        let read = file.read(&mut buffer[kept..])?;
        let filled = kept + read;
        // What may go on behind the buffer is looked at with what follows.
        let seen = if read == 0 { filled } else { filled.saturating_sub(STATED.end) };
        for at in 0..seen {
            let here = &buffer[at..filled];
            count += u64::from(here.starts_with(ENTRY));
            ends += u64::from(here.starts_with(END));
            if let Some(number) = here.strip_prefix(LIST_END).and(here.get(STATED)) {
                let number = number.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
                stated = stated.max(number);
            }
        }
        if read == 0 {
            return Ok((count.max(stated), ends));
        }
        buffer.copy_within(seen..filled, 0);
        kept = filled - seen;
    }
}

/// Takes out one file if it may be an answer, and says why not where its author should know.
fn one(
    archive: &mut ZipArchive<File>,
    index: usize,
    (folder, wanted): (&Path, &Wanted),
    taken: &mut usize,
) -> io::Result<Option<String>> {
    let shown = harmless_line(archive.name_for_index(index).unwrap_or_default(), 80);
    let left = |why: &str| Ok(Some(format!("`{shown}` was left in the archive: {why}")));
    let mut file = match archive.by_index(index) {
        Ok(file) => file,
        Err(ZipError::UnsupportedArchive(why)) => return left(&harmless_line(why, 80)),
        Err(error) => return Err(error.into()),
    };
    if file.is_dir() {
        return Ok(None);
    }
    if file.is_symlink() {
        return left("it is a link, and links are not followed");
    }
    let Some(path) = file.enclosed_name().filter(|path| path.components().count() <= DEEP) else {
        return left("its path leads out of the folder, or too deep into it");
    };
    if *taken == wanted.most {
        return left("there are too many files of its kind");
    }
    *taken += 1;
    let place = folder.join(&path);
    fs::create_dir_all(place.parent().unwrap_or(folder))?;
    let Ok(mut new) = File::create_new(&place) else {
        return left("another file has its name");
    };
    // A file that has more than is read is refused for its length later.
    io::copy(&mut (&mut file).take(wanted.largest + 1), &mut new)?;
    Ok(None)
}

/// The name of a file in a path.
fn last(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}
