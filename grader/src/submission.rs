//! What was handed in: answer files, and nothing else.
//!
//! No link is followed below the paths that the instructor names, so that nobody hands in a file
//! of the instructor's.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use exercise_spec::EXERCISES;
use tempfile::TempDir;

use crate::archive::{self, Unpacked, Wanted, is_zip};
use crate::text::harmless_line;
use crate::words::{self, Words, Written};

/// The largest answer that is read, in bytes. The reference answers have a tenth of it at most.
pub const LARGEST: u64 = 256_000;
/// What is taken out of a ZIP file. There are far fewer answers.
const WANTED: Wanted = Wanted {
    name: |name| is_answer(name) || words::is_file(name) || name.ends_with(".rs"),
    answer: is_answer,
    text: words::is_file,
    largest: LARGEST,
    most: 500,
};

/// How many files that are not used a notice names.
const NAMED: usize = 4;
/// How many entries of a folder are looked at to find out what is not used.
const LISTED: usize = 1_000;
/// How deep answers may lie in folders that hold nothing but one another.
const NESTED: usize = 5;
/// How many folders, of those that are equally deep, are searched for words.
const SEARCHED: usize = 200;

/// What one person handed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// A name that is safe to show and to call a file by, and that no other submission has.
    pub name: String,
    /// The folder.
    pub path: PathBuf,
}

impl Submission {
    /// What it was called when it was handed in.
    pub fn folder(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// What was taken of a submission, by the slugs of the exercises.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Collected {
    /// Texts of the answers.
    pub answers: BTreeMap<&'static str, String>,
    /// Answers in words.
    pub words: Words,
    /// Whether there are some beside these that nobody has read, as a notice says.
    pub unread: bool,
    /// Why files are no answers.
    pub refused: BTreeMap<&'static str, String>,
    /// What was left out and costs nothing.
    pub notices: Vec<String>,
}

/// Whether a folder has something of an answer.
pub type Holds = fn(&Path) -> bool;

/// The submissions that paths lead to. A path is a submission itself when answers lie at its top, or when it `holds`
/// answers and no folder in it does. Otherwise it is a folder of submissions: then each folder in it is one, and so
/// is each link or archive, which can tell what is wrong. An archive that lies beside what was unpacked from it, and `holds` answers, is none.
///
/// # Errors
///
/// When a path is no folder, cannot be read, holds nothing, or holds answers beside folders with
/// others.
pub fn find(paths: &[PathBuf], holds: Holds) -> Result<Vec<Submission>, String> {
    let mut found = BTreeSet::new();
    for path in paths {
        let within = submissions_in(root_of(path)?, holds);
        found.extend(within.map_err(|error| format!("{}: {error}", path.display()))?);
    }
    Ok(named(found))
}

/// One submission for each path, whatever it holds.
///
/// # Errors
///
/// When a path is no folder.
pub fn single(paths: &[PathBuf]) -> Result<Vec<Submission>, String> {
    Ok(named(paths.iter().map(|path| root_of(path)).collect::<Result<_, _>>()?))
}

fn root_of(path: &Path) -> Result<PathBuf, String> {
    let root = path.canonicalize().map_err(|error| {
        format!("{}: {error}; name a submission, or a folder of submissions", path.display())
    })?;
    if root.is_dir() || is_zip(&root) {
        return Ok(root);
    }
    Err(match is_archive(&root) {
        true => format!("{} is an archive; unpack it and name the folder", path.display()),
        false => format!("{} is a file; name the folder it lies in", path.display()),
    })
}

fn submissions_in(root: PathBuf, holds: Holds) -> Result<Vec<PathBuf>, String> {
    if !root.is_dir() {
        return Ok(vec![root]);
    }
    let entries = entries_of(&root, holds).map_err(|error| error.to_string())?;
    if let Some(answers) = answers_in(&root) {
        let mut others = entries.iter().filter(|folder| has_others(folder));
        let other = others.next();
        // One who is called `src` among others.
        if answers.ends_with("src") && answers.parent() == Some(&root) && others.next().is_some() {
            return Ok(entries);
        }
        return match other.filter(|_| !root.join("Cargo.toml").is_file()) {
            None => Ok(vec![root]),
            Some(other) => Err(beside(&root, &answers, other)),
        };
    }
    if holds(&root) && !entries.iter().any(|entry| holds(entry)) {
        return Ok(vec![root]);
    }
    match entries.as_slice() {
        [] => Err("there is no submission in it; name a folder of submissions, or give --single \
                   when it is itself the submission of somebody who handed in nothing"
            .to_owned()),
        [only] if is_download(only) && holds(only) => Ok(vec![root]),
        _ => Ok(entries),
    }
}

/// What may be a submission in a folder of submissions.
fn entries_of(root: &Path, holds: Holds) -> std::io::Result<Vec<PathBuf>> {
    let mut entries = Vec::new();
    for entry in fs::read_dir(root)? {
        let entry = entry?;
        let kind = entry.file_type()?;
        let path = entry.path();
        let packed = is_archive(&path) && !holds(&path.with_file_name(unpacked(&path)));
        let handed_in = kind.is_dir() || kind.is_symlink() || packed;
        let in_sight =
            !is_hidden(&entry.file_name()) || kind.is_dir() && answers_in(&path).is_some();
        if handed_in && in_sight {
            entries.push(path);
        }
    }
    entries.sort();
    Ok(entries)
}

/// Whether answers lie in a folder that is not where a repository keeps its own.
fn has_others(folder: &Path) -> bool {
    !folder.ends_with("exercises") && !folder.ends_with("src") && has_answers(folder)
}

/// Whether it is a folder and no link, and answers to exercises lie in it.
pub fn has_answers(folder: &Path) -> bool {
    answers_below(folder).is_some()
}

/// That nobody can tell whether it is one submission or many.
fn beside(root: &Path, answers: &Path, other: &Path) -> String {
    let here = match answers.strip_prefix(root) {
        Ok(path) if !path.as_os_str().is_empty() => {
            format!("`{}`", harmless_line(&slashed(path), 60))
        }
        _ => "it".to_owned(),
    };
    format!(
        "answers lie in {here} and in `{}` beside; when it is one submission, give --single, and \
         then those in {here} alone are graded; when it is a folder of submissions, name each of \
         them, with --single too",
        last(other)
    )
}

/// A path with `/` between folders.
fn slashed(path: &Path) -> String {
    path.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/")
}

/// Whether a folder is called as archives call the one they are unpacked to: by the name of a
/// branch, by a commit, or by the folder around it.
fn is_download(folder: &Path) -> bool {
    let name = |path: Option<&Path>| {
        path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned())
    };
    let Some(own) = name(Some(folder)) else { return false };
    let last = own.rsplit('-').next().unwrap_or_default();
    // The recipes put `__` between owner and repository.
    let recipe = own.contains("__");
    let commit =
        last.len() >= 7 && last.len() < own.len() && last.chars().all(|c| c.is_ascii_hexdigit());
    let branch = own.ends_with("-main") || own.ends_with("-master");
    !recipe && (commit || branch) || name(folder.parent()).is_some_and(|around| around == own)
}

/// Endings of archives.
const PACKED: [&str; 18] = [
    "zip", "zipx", "tar", "gz", "tgz", "bz2", "tbz", "tbz2", "xz", "txz", "zst", "tzst", "lz",
    "lzma", "7z", "rar", "jar", "cab",
];

/// Whether a file is called as an archive.
pub fn is_archive(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    unpacked(path) != *name && !path.is_dir()
}

/// The name of an archive without its ending, which is that of the folder it is unpacked to. Other
/// names stay.
pub fn unpacked(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let ends = |name: &str, endings: &[&str]| {
        let (stem, ending) = name.rsplit_once('.')?;
        let known = endings.contains(&&*ending.to_ascii_lowercase());
        (known && !stem.is_empty()).then(|| stem.to_owned())
    };
    let Some(stem) = ends(&name, &PACKED) else { return name.into_owned() };
    ends(&stem, &["tar"]).unwrap_or(stem)
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
    nested(root).find_map(|root| answers_in(&root))
}

/// A folder, the only folder in it, and so on.
pub(crate) fn nested(root: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let begin = Some(root.to_owned()).filter(|root| is_real_folder(root));
    std::iter::successors(begin, |root| only_folder(root)).take(NESTED)
}

/// Folders in which the files of a submission may lie, first where words belong.
fn within(root: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let folders = nested(root).flat_map(|root| {
        [root.join("exercises")].into_iter().chain(places(&root)).collect::<Vec<_>>()
    });
    folders.filter(|folder| is_real_folder(folder))
}

fn only_folder(root: &Path) -> Option<PathBuf> {
    let mut folders = entries_in(root).filter(|path| is_real_folder(path));
    folders.next().filter(|_| folders.next().is_none())
}

fn file_of(slug: &str) -> String {
    format!("{slug}.rs")
}

fn is_answer(name: &str) -> bool {
    name == words::FILE || EXERCISES.iter().any(|exercise| file_of(exercise.slug) == name)
}

pub(crate) fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Submissions with names of their own. A folder that need not be renamed keeps its name.
fn named(paths: BTreeSet<PathBuf>) -> Vec<Submission> {
    let raw = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (kept, renamed): (Vec<_>, Vec<_>) =
        paths.into_iter().partition(|path| safe_name(&raw(path)) == raw(path));
    // Some systems take names for the same that differ in capitals only.
    let asked: BTreeSet<String> =
        kept.iter().chain(&renamed).map(|path| safe_name(&raw(path)).to_lowercase()).collect();
    let mut taken = BTreeSet::new();
    let mut submissions = Vec::new();
    for path in kept.into_iter().chain(renamed) {
        let wanted = safe_name(&raw(&path));
        let free = |name: &String| !taken.contains(&name.to_lowercase());
        let numbered = (2..).map(|count| format!("{wanted}-{count}"));
        let numbered = numbered.filter(|name| !asked.contains(&name.to_lowercase()));
        let Some(name) = std::iter::once(wanted.clone()).chain(numbered).find(free) else {
            continue;
        };
        taken.insert(name.to_lowercase());
        submissions.push(Submission { name, path });
    }
    submissions.sort_by(|one, other| naturally(&one.name, &other.name));
    submissions
}

/// The order of names in which a number counts as one: `s2` comes before `s10`.
pub fn naturally(one: &str, other: &str) -> Ordering {
    let (mut left, mut right) = (one, other);
    while !left.is_empty() && !right.is_empty() {
        let (a, b);
        ((a, left), (b, right)) = (part(left), part(right));
        let order = match (digits(a), digits(b)) {
            (Some(a), Some(b)) => (a.len(), a).cmp(&(b.len(), b)),
            _ => a.cmp(b),
        };
        if order.is_ne() {
            return order;
        }
    }
    left.len().cmp(&right.len()).then_with(|| one.cmp(other))
}

/// The digits at the beginning of a text or all before the first of them, and the rest.
fn part(text: &str) -> (&str, &str) {
    let digit = text.starts_with(|letter: char| letter.is_ascii_digit());
    let other = |letter: char| letter.is_ascii_digit() != digit;
    text.split_at(text.find(other).unwrap_or(text.len()))
}

/// A number without the zeros it begins with.
fn digits(part: &str) -> Option<&str> {
    let number = part.starts_with(|letter: char| letter.is_ascii_digit());
    number.then(|| part.trim_start_matches('0'))
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
/// As [`Opened::of`], and when an answer cannot be read.
pub fn collect(submission: &Submission) -> Result<Collected, String> {
    let opened = Opened::of(&submission.path, &WANTED, has_answers)?;
    let mut collected = from_folder(&opened)?;
    collected.unread |= opened.text_left;
    collected.notices.splice(..0, opened.notices);
    Ok(collected)
}

/// Where the files of a submission lie: where it was handed in, or where it was unpacked.
#[derive(Debug)]
pub struct Opened {
    root: PathBuf,
    /// The folder around the archive.
    around: Option<PathBuf>,
    /// What was left out on the way.
    pub notices: Vec<String>,
    /// Whether a text for a person was.
    pub text_left: bool,
    _unpacked: Option<TempDir>,
}

impl Opened {
    /// Opens a folder, or the archive that it is or that lies where answers may lie and `holds` finds none.
    ///
    /// # Errors
    ///
    /// When it cannot be read, is an archive that is no ZIP file, or holds several: then nobody knows what is in it.
    pub fn of(root: &Path, wanted: &Wanted, holds: Holds) -> Result<Self, String> {
        const LINK: &str =
            "the submission is a link, and links are not followed: hand in the folder itself";
        let kind = fs::symlink_metadata(root).map_err(unreadable)?.file_type();
        let here = |notices| Self {
            root: root.to_owned(),
            around: None,
            notices,
            text_left: false,
            _unpacked: None,
        };
        match packed(root, holds).as_slice() {
            [zip] if is_zip(zip) => {
                let around = Some(root.to_owned()).filter(|root| is_real_folder(root));
                Ok(Self { around, ..Self::unpacked(zip, wanted, holds)? })
            }
            [archive] => Err(must_be_unpacked(archive)),
            [one, other, ..] => Err(format!(
                "there are several archives, `{}` and `{}`: leave the one that counts, and grade again",
                last(one),
                last(other)
            )),
            [] if is_archive(root) && kind.is_file() => Err(must_be_unpacked(root)),
            [] if !kind.is_dir() => Ok(here(vec![LINK.to_owned()])),
            [] => fs::read_dir(root).map(|_| here(Vec::new())).map_err(unreadable),
        }
    }

    fn unpacked(zip: &Path, wanted: &Wanted, holds: Holds) -> Result<Self, String> {
        let Unpacked { folder, notices, text_left, inner } = archive::unpacked(zip, wanted)?;
        match inner.filter(|_| !holds(folder.path())) {
            Some(inner) => Err(format!(
                "`{}` holds another archive, `{inner}`, and no answer beside it: unpack it and grade again",
                last(zip)
            )),
            None => Ok(Self {
                root: folder.path().to_owned(),
                around: None,
                notices,
                text_left,
                _unpacked: Some(folder),
            }),
        }
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder, and that around the archive which was unpacked to it.
    pub fn roots(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&*self.root).chain(self.around.as_deref())
    }

    /// A file of it as it is called there, harmless.
    fn shown(&self, path: &Path) -> String {
        let within = self.roots().find_map(|root| path.strip_prefix(root).ok());
        harmless_line(&slashed(within.unwrap_or(path)), 60)
    }
}

fn unreadable(error: std::io::Error) -> String {
    format!("the submission cannot be read: {error}")
}

fn from_folder(opened: &Opened) -> Result<Collected, String> {
    let root = opened.root();
    let mut collected = Collected::default();
    if !is_real_folder(root) {
        return Ok(collected);
    }
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
    }
    let (words, unread) = in_words(opened, folder.as_deref());
    collected.words = words;
    collected.unread = !unread.is_empty();
    collected.notices.extend(unread);
    collected.notices.extend(links(root));
    collected.notices.extend(unused(root, folder.as_deref().unwrap_or(root)));
    Ok(collected)
}

/// Answers in words: the first that are written where they are looked for, and why there may be others that nobody
/// has read.
fn in_words(opened: &Opened, folder: Option<&Path>) -> (Words, Vec<String>) {
    let near = near(opened, folder);
    let far = opened.roots().flat_map(called_answers).filter(|path| !near.contains(path));
    let (mut words, mut unread) = (Words::new(), BTreeSet::new());
    for path in near.iter().cloned().chain(far) {
        let Written { words: found, cut, astray } = match answer(&path) {
            Ok(None) => continue,
            Ok(Some(Ok(text))) => Written::of(&text),
            Ok(Some(Err(why))) | Err(why) => {
                unread.insert(why);
                continue;
            }
        };
        if words.is_empty() && near.contains(&path) {
            words = found;
        } else if !found.is_empty() && found != words {
            unread.insert(format!(
                "the answers in words of `{}` are not read: hand in one `{}`, in `exercises`",
                opened.shown(&path),
                words::FILE
            ));
        }
        unread.extend(cut.into_iter().map(|slug| {
            format!(
                "the answer to `{slug}` in `{}` is longer than {} characters, and nobody reads what stands behind \
                 them: shorten it",
                opened.shown(&path),
                words::LONGEST
            )
        }));
        unread.extend(astray.map(|line| {
            format!(
                "`{}` has words below no heading of a question, `{line}`: leave the headings as they were handed out",
                opened.shown(&path)
            )
        }));
    }
    (words, unread.into_iter().collect())
}

/// Where answers in words are looked for, those before others that count more: in `exercises`, in the folder of the
/// others or around it, and around the archive that these lay in.
fn near(opened: &Opened, folder: Option<&Path>) -> Vec<PathBuf> {
    let root = opened.root();
    let mut folders: Vec<PathBuf> = match folder {
        None => within(root).collect(),
        Some(folder) => {
            let around = folder.parent().filter(|_| folder != root).map(Path::to_owned);
            let exercises = Some(root.join("exercises")).filter(|it| is_real_folder(it));
            [exercises, around, Some(folder.to_owned())].into_iter().flatten().collect()
        }
    };
    folders.extend(opened.around.as_deref().into_iter().flat_map(within));
    folders.iter().map(|folder| folder.join(words::FILE)).collect()
}

/// Files that are called like that of the answers in words, or nearly so, wherever they lie.
fn called_answers(root: &Path) -> Vec<PathBuf> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_searched = |path: &PathBuf| !["target", "vendor"].contains(&&*name(path));
    let (mut found, mut folders) = (Vec::new(), vec![root.to_owned()]);
    for _ in 0..NESTED + 2 {
        let entries = folders.iter().flat_map(|folder| entries_in(folder));
        let (files, others): (Vec<_>, Vec<_>) =
            entries.partition(|path| words::is_file(&name(path)));
        folders = others.into_iter().filter(is_searched).filter(|it| is_real_folder(it)).collect();
        folders.sort();
        folders.truncate(SEARCHED);
        found.extend(files);
    }
    found.sort();
    found
}

/// What lies in a folder and is not hidden.
fn entries_in(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(LISTED);
    let seen = |path: &PathBuf| path.file_name().is_some_and(|name| !is_hidden(name));
    entries.map(|entry| entry.path()).filter(seen)
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

fn must_be_unpacked(archive: &Path) -> String {
    format!(
        "`{}` is an archive that nobody has unpacked, and no answer lies beside it: unpack it and \
         grade again",
        last(archive)
    )
}

/// The archive that a submission is, or those that lie in it where answers may lie, when there is no answer.
fn packed(root: &Path, holds: Holds) -> Vec<PathBuf> {
    let is_file = |path: &Path| fs::symlink_metadata(path).is_ok_and(|it| it.is_file());
    if is_zip(root) && is_file(root) {
        return vec![root.to_owned()];
    }
    if holds(root) {
        return Vec::new();
    }
    let archives_in =
        |folder: PathBuf| entries_in(&folder).filter(|path| is_archive(path) && is_file(path));
    let archives: BTreeSet<PathBuf> = within(root).flat_map(archives_in).collect();
    archives.into_iter().collect()
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
    const SETTINGS: [&str; 7] = [
        "Cargo.toml",
        "build.rs",
        ".cargo/config.toml",
        ".cargo/config",
        "rust-toolchain.toml",
        "rust-toolchain",
        "target",
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

/// Rust files and archives beside the answers, and answers in places that count less.
fn stray(root: &Path, folder: &Path) -> Vec<String> {
    let relative = |path: &Path| slashed(path.strip_prefix(root).unwrap_or(path));
    let entries =
        fs::read_dir(folder).into_iter().flatten().flatten().take(LISTED).map(|entry| entry.path());
    let beside = entries.filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let ours = ["main.rs", "lib.rs", "build.rs"].contains(&name.as_ref()) || is_answer(&name);
        path.extension() == Some(OsStr::new("rs")) && !ours || is_archive(path)
    });
    let mut names: Vec<String> = beside.map(|path| relative(&path)).collect();
    for other in places(root).filter(|other| other != folder) {
        let answers = EXERCISES.iter().map(|exercise| other.join(file_of(exercise.slug)));
        names.extend(answers.filter(|path| is_there(path)).map(|path| relative(&path)));
    }
    if answers_in(root).is_some() {
        let entries = entries_of(root, has_answers).unwrap_or_default();
        let others = entries.iter().filter(|folder| has_others(folder));
        names.extend(others.map(|folder| relative(folder)));
    }
    names.sort();
    names
}
