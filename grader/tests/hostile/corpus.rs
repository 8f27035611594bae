//! What a hostile submission is, and what must become of it.

use std::fs;
use std::path::Path;

/// One submission.
pub struct Hostile {
    /// What it does.
    pub name: &'static str,
    /// What its folder is called, where that is the point.
    pub folder: Option<&'static str>,
    /// The exercise it is handed in for.
    pub exercise: &'static str,
    pub made: Made,
    pub want: Want,
    /// A part of what is told.
    pub says: &'static str,
}

/// How it is made.
pub enum Made {
    /// Of an answer alone.
    Answer(String),
    /// In a folder of its own.
    Folder(fn(&Path)),
}

/// What must become of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Want {
    /// A person must look.
    NotGraded,
    Missing,
    NotBegun,
    Refused,
    DoesNotCompile,
    /// It runs, and earns this part of the points at most.
    Runs(f64),
}

pub const LEFT: &str = "left_perturbation";
pub const ALONG: &str = "along_or_across";
pub const FILL: &str = "fill_in";

/// A submission of an answer alone.
pub fn row(
    name: &'static str,
    exercise: &'static str,
    answer: String,
    want: Want,
    says: &'static str,
) -> Hostile {
    Hostile { name, folder: None, exercise, made: Made::Answer(answer), want, says }
}

/// A submission that brings more than an answer to [`LEFT`].
pub fn folder(name: &'static str, made: fn(&Path), want: Want, says: &'static str) -> Hostile {
    Hostile { name, folder: None, exercise: LEFT, made: Made::Folder(made), want, says }
}

/// Writes a file and the folders around it.
pub fn put(root: &Path, path: &str, text: impl AsRef<[u8]>) {
    let path = root.join(path);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, text).expect("a file");
}

/// The right answer to an exercise.
pub fn right(slug: &str) -> String {
    read(&format!("solutions/src/{slug}.rs"))
}

/// The skeleton of an exercise with a line more, so that it counts as begun.
pub fn skeleton(slug: &str) -> String {
    format!("{}// To be continued.\n", untouched(slug))
}

/// The skeleton of an exercise.
pub fn untouched(slug: &str) -> String {
    read(&format!("exercises/src/{slug}.rs"))
}

fn read(path: &str) -> String {
    fs::read_to_string(grader::repository().join(path)).expect("a file of the book")
}

/// The skeleton with `body` in place of what is to be written, and more behind it.
pub fn every(slug: &str, body: &str, more: &str) -> String {
    let line = |line: &str| if line.trim().starts_with("todo!") { body } else { line }.to_owned();
    let text: Vec<String> = skeleton(slug).lines().map(line).collect();
    format!("{}\n\n{more}\n", text.join("\n"))
}

/// A text with another body in one of its functions.
pub fn with_body(text: &str, function: &str, body: &str) -> String {
    let (before, rest) = text.split_once(&format!("pub fn {function}(")).expect("a function");
    let (signature, rest) = rest.split_once("{\n").expect("a body");
    let (_, after) = rest.split_once("\n}\n").expect("its end");
    format!("{before}pub fn {function}({signature}{{\n{body}\n}}\n{after}")
}

/// The right answer with a statement at the beginning of each function that is called.
pub fn right_after(slug: &str, statement: &str, more: &str) -> String {
    let mut text = String::new();
    let mut in_signature = false;
    for line in right(slug).lines() {
        text += line;
        text += "\n";
        in_signature |= line.starts_with("pub fn");
        if in_signature && line.ends_with('{') {
            in_signature = false;
            text += statement;
            text += "\n";
        }
    }
    text + more
}

/// The right answer with more behind it.
pub fn right_and(slug: &str, more: &str) -> String {
    format!("{}\n{more}\n", right(slug))
}
