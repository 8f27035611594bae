//! Looks for what students must not have.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::Tree;
use super::tree::{entries, text};

/// Where the answers, the wrong ones, the hidden instances and what an answer in words is worth
/// lie.
const SECRET: [&str; 3] = ["solutions/src", "tests/src", "tests/rubrics"];

/// What students have by right. A line that stands here too betrays nothing.
const KNOWN: [&str; 3] = ["exercises/skeletons", "exercises/spec/src", "code/src"];

/// Folders and files that students have no business with, by any part of their path.
const NAMES: [&str; 8] =
    ["solutions", "misconceptions", "rubrics", "mutants", "grader", "press", "exhibits", "hidden"];

/// Words that only stand where hidden things are called.
const WORDS: [&str; 5] =
    ["book-tests", "book_tests", "hidden_checks", "solutions::", "../solutions"];

/// Letters and digits that make a line more than a brace and a keyword.
const TELLING: usize = 12;

/// What in a tree students must not have: names, and lines of answers, hidden checks and rubrics.
/// Each is a sentence. Sources of dependencies are not looked at.
///
/// # Errors
///
/// A sentence when the repository cannot be read.
pub fn leaks(root: &Path, tree: &Tree) -> Result<Vec<String>, String> {
    let secret = secret(root)?;
    let known = Known::of(root)?;
    let mut found = Vec::new();
    for (path, bytes) in tree.iter().filter(|(path, _)| !path.starts_with("vendor/")) {
        let stem = |part: &&str| part.split('.').next().is_some_and(|stem| NAMES.contains(&stem));
        if let Some(part) = path.split('/').find(stem) {
            found.push(format!("{path}: students have no business with `{part}`; leave it out"));
        }
        let shown = String::from_utf8_lossy(bytes);
        for word in WORDS.iter().filter(|word| shown.contains(**word)) {
            found.push(format!("{path} says `{word}`, which students do not have; take it out"));
        }
        // What stands in these is known.
        if KNOWN.iter().any(|known| path.starts_with(known)) {
            continue;
        }
        let betrays = |line: &&String| shown.contains(line.as_str()) && !known.has(line);
        for line in secret.keys().filter(betrays) {
            found.push(format!("{path} has a line of {}: `{line}`; take it out", secret[line]));
        }
    }
    Ok(found)
}

/// Telling lines of what is secret, and where they stand.
fn secret(root: &Path) -> Result<BTreeMap<String, String>, String> {
    let mut secret = BTreeMap::new();
    for folder in SECRET {
        each(root, folder, &mut |path, text| {
            for (number, line) in text.lines().map(str::trim).enumerate() {
                if telling(line) {
                    secret.entry(line.to_owned()).or_insert(format!("{path}:{}", number + 1));
                }
            }
        })?;
    }
    Ok(secret)
}

/// What students have by right.
struct Known {
    text: String,
    lines: BTreeSet<String>,
}

impl Known {
    fn of(root: &Path) -> Result<Self, String> {
        let mut text = String::new();
        for folder in KNOWN {
            each(root, folder, &mut |_, file| text += file)?;
        }
        let lines = text.lines().map(|line| line.trim().to_owned()).collect();
        Ok(Self { text, lines })
    }

    /// Whether a line is one of theirs, or a part of one.
    fn has(&self, line: &str) -> bool {
        self.lines.contains(line) || self.text.contains(line)
    }
}

/// Whether a line says something: neither an import, nor a heading, nor a few letters.
fn telling(line: &str) -> bool {
    let plain = line.starts_with("use ") || line.starts_with('#');
    !plain && line.chars().filter(|letter| letter.is_alphanumeric()).count() >= TELLING
}

/// Every file of a folder and those below it.
fn each(root: &Path, folder: &str, see: &mut dyn FnMut(&str, &str)) -> Result<(), String> {
    for (path, is_folder) in entries(root, folder)? {
        match is_folder {
            true => each(root, &path, see)?,
            false => see(&path, &text(root, &path)?),
        }
    }
    Ok(())
}
