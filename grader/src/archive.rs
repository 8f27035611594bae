//! ZIP files that students hand in, unpacked without trusting a word in them.
//!
//! Of the names in an archive only those lead anywhere that stay below the folder; of the files only
//! those are written that a submission may consist of, and no more of each than is read anyway; links
//! are none of them. Sizes that the archive states do not matter.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::ops::Range;
use std::path::Path;

use tempfile::TempDir;
use zip::ZipArchive;

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
    /// Whether it is a part of an answer. These come first, and no archive is opened of which one cannot be taken out. A
    /// link is none, nor what has a path that leads out.
    pub answer: fn(&str) -> bool,
    /// Whether it is a text for a person. These come next.
    pub text: fn(&str) -> bool,
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
    /// Whether a text for a person was.
    pub text_left: bool,
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
/// A sentence when it cannot be read, is too large to be looked at, or keeps back a part of an answer.
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
    let inner = archive.file_names().find(|name| is_archive(Path::new(name)));
    let inner = inner.map(|name| harmless_line(name, 60));
    let called = |index: &usize| last(archive.name_for_index(*index).unwrap_or_default());
    let named = (0..archive.len()).filter(|index| (wanted.name)(called(index)));
    let (answers, mut others): (Vec<_>, Vec<_>) =
        named.partition(|index| (wanted.answer)(called(index)));
    others.sort_by_key(|index| !(wanted.text)(called(index)));
    let (mut room, mut text_left) = (wanted.most, false);
    for index in answers.iter().chain(&others).copied() {
        let name = archive.name_for_index(index).unwrap_or_default();
        let (shown, is_text) = (harmless_line(name, 80), (wanted.text)(last(name)));
        let why_not = match one(&mut archive, index, (folder.path(), wanted), &mut room) {
            Ok(why_not) => why_not,
            Err(why) if answers.contains(&index) => {
                return Err(told(format!("holds `{shown}`, which cannot be taken out ({why})")));
            }
            Err(why) => Some(why),
        };
        text_left |= is_text && why_not.is_some();
        notices.extend(why_not.map(|why| format!("`{shown}` was left in the archive: {why}")));
    }
    notices.truncate(4);
    Ok(Unpacked { folder, notices, text_left, inner })
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

/// Takes out one file, or says why it has to stay there.
///
/// # Errors
///
/// Why it cannot be taken out, which need not be its author's doing.
fn one(
    archive: &mut ZipArchive<File>,
    index: usize,
    (folder, wanted): (&Path, &Wanted),
    room: &mut usize,
) -> Result<Option<String>, String> {
    let unreadable = |error: &dyn std::fmt::Display| harmless_line(&error.to_string(), 200);
    let mut file = archive.by_index(index).map_err(|error| unreadable(&error))?;
    if file.is_dir() {
        return Ok(None);
    }
    if file.is_symlink() {
        return Ok(Some("it is a link, and links are not followed".to_owned()));
    }
    let Some(path) = file.enclosed_name().filter(|path| path.components().count() <= DEEP) else {
        return Ok(Some("its path leads out of the folder, or too deep into it".to_owned()));
    };
    *room = room.checked_sub(1).ok_or("there are too many files of its kind")?;
    let place = folder.join(&path);
    fs::create_dir_all(place.parent().unwrap_or(folder)).map_err(|error| unreadable(&error))?;
    let mut new = File::create_new(&place).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => "another file has its name".to_owned(),
        _ => unreadable(&error),
    })?;
    // A file that has more than is read is refused for its length later.
    let copied = io::copy(&mut (&mut file).take(wanted.largest + 1), &mut new);
    copied.map(|_| None).map_err(|error| unreadable(&error))
}

/// The name of a file in a path.
fn last(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}
