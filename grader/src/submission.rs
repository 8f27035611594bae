//! What was handed in: answer files, and nothing else.
//!
//! No link is followed below the paths that the instructor names, so that nobody hands in a file
//! of the instructor's.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use exercise_spec::EXERCISES;

use crate::text::harmless_line;

/// The largest answer that is read, in bytes. The reference answers have a tenth of it at most.
pub const LARGEST: u64 = 256_000;

/// How many files that are not used a notice names.
const NAMED: usize = 4;
/// How many entries of a folder are looked at to find out what is not used.
const LISTED: usize = 1_000;
/// How deep answers may lie in folders that hold nothing but one another.
const NESTED: usize = 4;

/// What one person handed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// A name that is safe to show and to call a file by, and that no other submission has.
    pub name: String,
    /// The folder.
    pub path: PathBuf,
}

/// What was taken of a submission, by the slugs of the exercises.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Collected {
    /// Texts of the answers.
    pub answers: BTreeMap<&'static str, String>,
    /// Why files are no answers.
    pub refused: BTreeMap<&'static str, String>,
    /// What was left out and costs nothing.
    pub notices: Vec<String>,
}

/// The submissions that paths lead to. A path is a submission itself, or a folder of submissions:
/// then each folder in it is one, and so is each link or archive, which can tell what is wrong.
///
/// # Errors
///
/// When a path is no folder or cannot be read.
pub fn find(paths: &[PathBuf]) -> Result<Vec<Submission>, String> {
    let mut found = BTreeSet::new();
    for path in paths {
        let root = path.canonicalize().map_err(|error| {
            format!("{}: {error}; name a submission, or a folder of submissions", path.display())
        })?;
        if !root.is_dir() {
            return Err(format!("{} is a file; name the folder it lies in", path.display()));
        }
        found.extend(submissions_in(root).map_err(|error| format!("{}: {error}", path.display()))?);
    }
    Ok(named(found))
}

fn submissions_in(root: PathBuf) -> std::io::Result<Vec<PathBuf>> {
    let mut entries = Vec::new();
    for entry in fs::read_dir(&root)? {
        let entry = entry?;
        let kind = entry.file_type()?;
        let path = entry.path();
        let handed_in = kind.is_dir() || kind.is_symlink() || is_archive(&path);
        let in_sight =
            !is_hidden(&entry.file_name()) || kind.is_dir() && answers_in(&path).is_some();
        if handed_in && in_sight {
            entries.push(path);
        }
    }
    let whole = match entries.as_slice() {
        [] => true,
        [only] if is_real_folder(only) => {
            answers_in(&root).is_some() || is_download(only) && answers_below(only).is_some()
        }
        _ => {
            answers_in(&root).is_some()
                && (root.join("Cargo.toml").is_file() || !hold_answers(&entries))
        }
    };
    Ok(if whole { vec![root] } else { entries })
}

/// Whether answers lie in one of these folders that are not where a repository keeps its own.
fn hold_answers(folders: &[PathBuf]) -> bool {
    let others =
        folders.iter().filter(|folder| !folder.ends_with("exercises") && !folder.ends_with("src"));
    others.filter(|folder| is_real_folder(folder)).any(|folder| answers_in(folder).is_some())
}

/// Whether a folder is called as archives call the one they are unpacked to: by the name of a
/// branch, by a commit, or by the folder around it.
fn is_download(folder: &Path) -> bool {
    let name = |path: Option<&Path>| {
        path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned())
    };
    let Some(own) = name(Some(folder)) else { return false };
    let last = own.rsplit('-').next().unwrap_or_default();
    let commit =
        last.len() >= 7 && last.len() < own.len() && last.chars().all(|c| c.is_ascii_hexdigit());
    let branch = own.ends_with("-main") || own.ends_with("-master");
    commit || branch || name(folder.parent()).is_some_and(|around| around == own)
}

fn is_archive(path: &Path) -> bool {
    let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
    matches!(ending.as_str(), "zip" | "tar" | "gz" | "tgz" | "bz2" | "xz" | "zst" | "7z" | "rar")
}

/// Whether systems and tools keep their own things under such a name.
fn is_hidden(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    name.starts_with('.') || name == "__MACOSX"
}

/// Whether it is a folder and no link to one.
fn is_real_folder(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|it| it.is_dir())
}

/// The folder of a submission that holds answers, if there is one.
fn answers_in(root: &Path) -> Option<PathBuf> {
    places(root).find(|folder| {
        EXERCISES.iter().any(|exercise| is_there(&folder.join(file_of(exercise.slug))))
    })
}

/// Folders in which answers may lie, those before others that count more.
fn places(root: &Path) -> impl Iterator<Item = PathBuf> {
    let (exercises, own) = (root.join("exercises"), root.join("src"));
    let deep = is_real_folder(&exercises).then(|| exercises.join("src"));
    let here = [deep, Some(own), Some(root.to_owned())];
    here.into_iter().flatten().filter(|folder| is_real_folder(folder))
}

/// The same, also in the only folder of a folder, as an archive may make it.
fn answers_below(root: &Path) -> Option<PathBuf> {
    let mut root = root.to_owned();
    for _ in 0..NESTED {
        if let Some(folder) = answers_in(&root) {
            return Some(folder);
        }
        let seen = |path: &PathBuf| {
            path.file_name().is_some_and(|name| !is_hidden(name)) && is_real_folder(path)
        };
        let mut folders =
            fs::read_dir(&root).ok()?.flatten().take(LISTED).map(|entry| entry.path()).filter(seen);
        root = folders.next().filter(|_| folders.next().is_none())?;
    }
    None
}

fn file_of(slug: &str) -> String {
    format!("{slug}.rs")
}

fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Submissions with names of their own. A folder that need not be renamed keeps its name.
fn named(paths: BTreeSet<PathBuf>) -> Vec<Submission> {
    let raw = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (kept, renamed): (Vec<_>, Vec<_>) =
        paths.into_iter().partition(|path| safe_name(&raw(path)) == raw(path));
    let mut taken = BTreeSet::new();
    let mut submissions = Vec::new();
    for path in kept.into_iter().chain(renamed) {
        let wanted = safe_name(&raw(&path));
        // Some systems take names for the same that differ in capitals only.
        let free = |name: &String| !taken.contains(&name.to_lowercase());
        let numbered = (2..).map(|count| format!("{wanted}-{count}"));
        let Some(name) = std::iter::once(wanted.clone()).chain(numbered).find(free) else {
            continue;
        };
        taken.insert(name.to_lowercase());
        submissions.push(Submission { name, path });
    }
    submissions.sort_by(|one, other| one.name.cmp(&other.name));
    submissions
}

/// A name that can be shown in any terminal and be given to a file on any system.
fn safe_name(raw: &str) -> String {
    const LONGEST: usize = 100;
    let mut name = String::new();
    for letter in raw.chars() {
        let accent =
            ('\u{300}'..='\u{36f}').contains(&letter) && name.ends_with(char::is_alphabetic);
        let kept = letter.is_alphanumeric() || accent || "-_.+@,()~# '".contains(letter);
        let letter = if kept { letter } else { '_' };
        if name.len() + letter.len_utf8() > LONGEST {
            break;
        }
        name.push(letter);
    }
    // Windows drops these.
    while name.ends_with(['.', ' ']) {
        name.pop();
    }
    if name.is_empty()
        || name.starts_with(['-', '.', '~', ' ', '+', '@', '#'])
        || is_reserved(&name)
    {
        name.insert(0, '_');
    }
    name
}

/// Whether Windows takes it for a device.
fn is_reserved(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_uppercase();
    let numbered = stem.strip_prefix("COM").or_else(|| stem.strip_prefix("LPT"));
    matches!(stem.as_str(), "CON" | "PRN" | "AUX" | "NUL")
        || numbered.is_some_and(|rest| rest.chars().count() == 1)
}

/// Takes the answers of a submission, and nothing else.
///
/// # Errors
///
/// When the submission cannot be read: then nobody knows what is in it.
pub fn collect(submission: &Submission) -> Result<Collected, String> {
    let mut collected = Collected::default();
    let root = &submission.path;
    let unreadable = |error: std::io::Error| format!("the submission cannot be read: {error}");
    let kind = fs::symlink_metadata(root).map_err(unreadable)?.file_type();
    if !kind.is_dir() {
        let notice = if kind.is_symlink() {
            "the submission is a link, and links are not followed: hand in the folder itself"
        } else {
            "the submission is a file and not a folder: it must be unpacked before it is graded"
        };
        collected.notices.push(notice.to_owned());
        return Ok(collected);
    }
    fs::read_dir(root).map_err(unreadable)?;
    let folder = answers_below(root);
    if let Some(folder) = &folder {
        for exercise in EXERCISES {
            match answer(&folder.join(file_of(exercise.slug)))? {
                None => {}
                Some(Ok(text)) => drop(collected.answers.insert(exercise.slug, text)),
                Some(Err(why)) => drop(collected.refused.insert(exercise.slug, why)),
            }
        }
    } else {
        collected.notices.push(format!(
            "there is no answer in the submission: answers lie in `exercises/src` and are called \
                `{}` and so on",
            file_of(EXERCISES[0].slug)
        ));
        collected.notices.extend(packed(root));
    }
    collected.notices.extend(links(root));
    collected.notices.extend(unused(root, folder.as_deref().unwrap_or(root)));
    Ok(collected)
}

/// The text of an answer, why it is none, or nothing when there is no such file.
///
/// # Errors
///
/// When it cannot be read, which is not the student's doing.
fn answer(path: &Path) -> Result<Option<Result<String, String>>, String> {
    let unreadable = |error: std::io::Error| format!("`{}` cannot be read: {error}", last(path));
    let metadata = match fs::symlink_metadata(path) {
        Ok(metadata) => metadata,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unreadable(error)),
    };
    if let Some(why) = no_answer(&metadata) {
        return Ok(Some(Err(format!("`{}` {why}", last(path)))));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST {
        return Ok(Some(Err(format!(
            "`{}` grew while it was read. Hand it in once more.",
            last(path)
        ))));
    }
    Ok(Some(String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|byte| **byte == b'\n').count();
        let byte = error.as_bytes()[valid.len()];
        format!(
            "`{}` is no UTF-8: there is a byte {byte:#04x} in line {line}. Save the file as UTF-8.",
            last(path)
        )
    })))
}

/// What keeps a file from being an answer, as the end of a sentence.
fn no_answer(metadata: &Metadata) -> Option<String> {
    let kind = metadata.file_type();
    if kind.is_symlink() {
        return Some("is a link, and links are not followed. Hand in the file itself.".to_owned());
    }
    if kind.is_dir() {
        return Some("is a folder. Hand in a file of that name.".to_owned());
    }
    if !kind.is_file() {
        return Some("is a pipe or a device. Hand in an ordinary file.".to_owned());
    }
    (metadata.len() > LARGEST).then(|| {
        format!(
            "has {} bytes and may have {LARGEST}. An answer needs no such amount of text: what is \
                in it that could be computed?",
            metadata.len()
        )
    })
}

/// The last part of a path, harmless.
fn last(path: &Path) -> String {
    harmless_line(&path.file_name().unwrap_or_default().to_string_lossy(), 60)
}

/// A notice of an archive that nobody has unpacked.
fn packed(root: &Path) -> Option<String> {
    let mut paths = fs::read_dir(root).ok()?.flatten().take(LISTED).map(|entry| entry.path());
    let archive = paths.find(|path| is_archive(path))?;
    Some(format!("`{}` must be unpacked before it is graded", last(&archive)))
}

/// A notice of folders that are links where answers should lie.
fn links(root: &Path) -> Option<String> {
    let is_link = |path: &Path| fs::symlink_metadata(path).is_ok_and(|it| it.is_symlink());
    let link = ["exercises", "exercises/src", "src"]
        .into_iter()
        .find(|folder| is_link(&root.join(folder)))?;
    Some(format!("`{link}` is a link, and links are not followed: hand in the folder itself"))
}

/// A notice of files that their author may believe to be used.
fn unused(root: &Path, folder: &Path) -> Option<String> {
    const SETTINGS: [&str; 8] = [
        "Cargo.toml",
        "build.rs",
        ".cargo/config.toml",
        ".cargo/config",
        "rust-toolchain.toml",
        "rust-toolchain",
        "target",
        "exercises/Cargo.toml",
    ];
    let mut names: Vec<String> =
        SETTINGS.into_iter().filter(|name| is_there(&root.join(name))).map(str::to_owned).collect();
    names.extend(stray(root, folder));
    let others = names.len().saturating_sub(NAMED);
    names.truncate(NAMED);
    let list: Vec<String> =
        names.iter().map(|name| format!("`{}`", harmless_line(name, 60))).collect();
    let more = if others > 0 { format!(" and {others} more") } else { String::new() };
    (!list.is_empty()).then(|| {
        format!(
            "not used: {}{more}. Answers alone are graded, and everything else is the \
            grader's own.",
            list.join(", ")
        )
    })
}

/// Rust files beside the answers, and answers in places that count less.
fn stray(root: &Path, folder: &Path) -> Vec<String> {
    let relative = |path: &Path| {
        let path = path.strip_prefix(root).unwrap_or(path).to_string_lossy();
        path.replace(std::path::MAIN_SEPARATOR, "/")
    };
    let is_answer = |name: &str| EXERCISES.iter().any(|exercise| file_of(exercise.slug) == name);
    let entries =
        fs::read_dir(folder).into_iter().flatten().flatten().take(LISTED).map(|entry| entry.path());
    let beside = entries.filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let ours = ["main.rs", "lib.rs", "build.rs"].contains(&name.as_ref()) || is_answer(&name);
        path.extension() == Some(OsStr::new("rs")) && !ours
    });
    let mut names: Vec<String> = beside.map(|path| relative(&path)).collect();
    for other in places(root).filter(|other| other != folder) {
        let answers = EXERCISES.iter().map(|exercise| other.join(file_of(exercise.slug)));
        names.extend(answers.filter(|path| is_there(path)).map(|path| relative(&path)));
    }
    names.sort();
    names
}
