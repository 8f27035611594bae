//! Paths that lead out of an answer.

use exercise_spec::exercise;

use super::tokens::Tokens;

/// Modules of the standard library that have nothing to reach where answers run.
const EMPTY: &[(&str, &str)] = &[
    ("process", "there is no process to end or to start. A call ends when it returns, or panics."),
    ("fs", "there are no files. An answer has its arguments, and gives its output back."),
    ("net", "there is no network. An answer has its arguments, and gives its output back."),
    ("env", "there is no environment. An answer has its arguments, and gives its output back."),
    (
        "thread",
        "there is one thread, and no way to start or to stop another. Compute one thing after the \
            other.",
    ),
    ("os", "there is no operating system. An answer has its arguments, and gives its output back."),
    (
        "arch",
        "no instruction of a certain processor can be called. Write it with numbers and nalgebra.",
    ),
];

/// What of `exercise_spec` an answer needs, beside the modules of the exercises.
const DATA: [&str; 2] = ["camera", "navigation"];

/// What it names and may not, with the lines.
pub fn findings(tokens: &Tokens) -> Vec<(usize, String)> {
    let at_line = |at: usize| {
        let sentences = match tokens.word(at) {
            "std" | "core" => library(tokens, at),
            "exercise_spec" => declaration(tokens, at),
            "crate" => whole(tokens, at),
            "super" => above(tokens, at),
            _ => Vec::new(),
        };
        sentences.into_iter().map(move |sentence| (tokens.line(at), sentence))
    };
    (0..tokens.len()).flat_map(at_line).collect()
}

fn library(tokens: &Tokens, at: usize) -> Vec<String> {
    let root = tokens.word(at);
    let empty = |name: &str| EMPTY.iter().find(|(module, _)| *module == name);
    let told =
        |(module, why): &(&str, &str)| format!("`{root}::{module}`: where answers run, {why}");
    next(tokens, at).into_iter().filter_map(|name| empty(&name).map(told)).collect()
}

/// Data and their types may be taken of what declares the exercise. What is behind its checks
/// knows what they expect.
fn declaration(tokens: &Tokens, at: usize) -> Vec<String> {
    let allowed = |name: &String| DATA.contains(&name.as_str()) || exercise(name).is_some();
    let next = next(tokens, at);
    if !tokens.in_macro(at) && !next.is_empty() && next.iter().all(allowed) {
        return Vec::new();
    }
    let sentence = "`exercise_spec`: an answer takes the types of its arguments from it and \
        nothing else, and by a `use` as in the skeleton. Take the lines of the skeleton.";
    vec![sentence.to_owned()]
}

fn whole(tokens: &Tokens, at: usize) -> Vec<String> {
    if !tokens.separates(at + 1) {
        return Vec::new();
    }
    let sentence = "`crate::` leads out of the answer, and each answer stands alone. Write \
        `self::`, or `super::` in a module of it.";
    vec![sentence.to_owned()]
}

fn above(tokens: &Tokens, at: usize) -> Vec<String> {
    let mut first = at;
    while tokens.follows_path(first) && first >= 3 && tokens.word(first - 3) == "super" {
        first -= 3;
    }
    let count = 1 + (at - first) / 3;
    if count <= tokens.modules(at) {
        return Vec::new();
    }
    vec![
        "`super` leads out of the answer here, and each answer stands alone. Leave it out."
            .to_owned(),
    ]
}

/// What stands behind `root::`, of every branch where it is a tree. Nothing when no path follows.
fn next(tokens: &Tokens, at: usize) -> Vec<String> {
    if !tokens.separates(at + 1) {
        return Vec::new();
    }
    let begin = at + 3;
    if !tokens.is(begin, '{') {
        return vec![name(tokens, begin)];
    }
    let (mut names, mut depth, mut at) = (Vec::new(), 0_usize, begin);
    while at < tokens.len() {
        if tokens.is(at, '{') {
            depth += 1;
        } else if tokens.is(at, '}') {
            depth -= 1;
        }
        match depth {
            0 => break,
            1 if (tokens.is(at, '{') || tokens.is(at, ',')) && !tokens.is(at + 1, '}') => {
                let leading = if tokens.separates(at + 1) { at + 3 } else { at + 1 };
                names.push(name(tokens, leading));
            }
            _ => {}
        }
        at += 1;
    }
    names
}

/// A word, or a mark that no module is called by.
fn name(tokens: &Tokens, at: usize) -> String {
    match tokens.word(at) {
        "" => "*".to_owned(),
        word => word.to_owned(),
    }
}
