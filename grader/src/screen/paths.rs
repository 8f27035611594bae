//! Paths that lead out of an answer.

use exercise_runner::tokens::Tokens;
use exercise_spec::{EXERCISES, exercise};

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

/// Modules of what declares the exercises that several of them share.
const SHARED: &[&str] = &["camera", "navigation"];

/// What an answer to an exercise names and may not, with the lines.
pub fn findings(tokens: &Tokens, slug: &str) -> Vec<(usize, String)> {
    let at_line = |at: usize| {
        let sentences = match tokens.word(at) {
            "std" | "core" => library(tokens, at),
            "exercise_spec" => declaration(tokens, at, slug),
            "crate" => whole(tokens, at),
            "super" => above(tokens, at),
            _ => Vec::new(),
        };
        sentences.into_iter().map(move |sentence| (tokens.line(at), sentence))
    };
    (0..tokens.len()).filter(|at| !tokens.place(*at).test).flat_map(at_line).collect()
}

fn library(tokens: &Tokens, at: usize) -> Vec<String> {
    let root = tokens.word(at);
    let empty = |name: &str| EMPTY.iter().find(|(module, _)| *module == name);
    let told =
        |(module, why): &(&str, &str)| format!("`{root}::{module}`: where answers run, {why}");
    next(tokens, at).into_iter().filter_map(|name| empty(&name).map(told)).collect()
}

/// The types of arguments and outputs may be taken of what declares the exercise. What is behind
/// its checks knows what they expect, and types of other exercises may do what this one asks for.
fn declaration(tokens: &Tokens, at: usize, slug: &str) -> Vec<String> {
    let own = exercise(slug);
    let is_own = |name: &str| own.is_some_and(|it| it.types.contains(&name));
    let is_type = |name: &str| EXERCISES.iter().any(|it| it.types.contains(&name));
    // The camera that exercises share is the library's, with all that it does.
    let shares = own.is_some_and(|it| !it.forbidden.contains(&"jacobians"));
    let allowed = |path: &Vec<String>| match path.as_slice() {
        [module, name, ..] if module == slug => is_own(name),
        [module, name, ..] => shares && SHARED.contains(&module.as_str()) && is_type(name),
        _ => false,
    };
    let paths = paths(tokens, at, 3);
    if !tokens.place(at).in_macro() && !paths.is_empty() && paths.iter().all(allowed) {
        return Vec::new();
    }
    let sentence = "`exercise_spec`: an answer takes the types of its arguments from it and \
        nothing else, and by a `use` as in the skeleton. Take the lines of the skeleton.";
    vec![sentence.to_owned()]
}

/// Every path that begins with the word here, without that word, and with so many words at most:
/// one, or those of a tree.
fn paths(tokens: &Tokens, at: usize, most: usize) -> Vec<Vec<String>> {
    if most == 0 || !tokens.separates(at + 1) {
        return Vec::new();
    }
    let begin = at + 3;
    let branches = if tokens.is(begin, '{') { branches(tokens, begin) } else { vec![begin] };
    let mut all = Vec::new();
    for branch in branches {
        let behind = paths(tokens, branch, most - 1);
        if behind.is_empty() {
            all.push(vec![name(tokens, branch)]);
        }
        for mut path in behind {
            path.insert(0, name(tokens, branch));
            all.push(path);
        }
    }
    all
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
    let (mut first, mut count) = (at, 1);
    let modules = tokens.place(at).modules;
    while count <= modules
        && tokens.follows_path(first)
        && first >= 3
        && tokens.word(first - 3) == "super"
    {
        (first, count) = (first - 3, count + 1);
    }
    if count <= modules {
        return Vec::new();
    }
    let open = if first > 0 && tokens.keyword(first - 1) == "in" { first - 1 } else { first };
    let is_visibility = open >= 2 && tokens.is(open - 1, '(') && tokens.keyword(open - 2) == "pub";
    let sentence = if is_visibility {
        "`pub(super)` leads out of the answer here, and each answer stands alone. Write `pub`, or \
            nothing, as in `pub fn` and `fn`."
    } else {
        "`super` leads out of the answer here, and each answer stands alone. Leave it out."
    };
    vec![sentence.to_owned()]
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
    branches(tokens, begin).into_iter().map(|branch| name(tokens, branch)).collect()
}

/// Where the branches of a tree begin that opens here.
fn branches(tokens: &Tokens, open: usize) -> Vec<usize> {
    let (mut found, mut depth) = (Vec::new(), 0_usize);
    for at in open..tokens.len() {
        if tokens.is(at, '{') {
            depth += 1;
        } else if tokens.is(at, '}') {
            depth -= 1;
        }
        match depth {
            0 => break,
            1 if (tokens.is(at, '{') || tokens.is(at, ',')) && !tokens.is(at + 1, '}') => {
                found.push(if tokens.separates(at + 1) { at + 3 } else { at + 1 });
            }
            _ => {}
        }
    }
    found
}

/// A word, or a mark that no module is called by.
fn name(tokens: &Tokens, at: usize) -> String {
    match tokens.word(at) {
        "" => "*".to_owned(),
        word => word.to_owned(),
    }
}
