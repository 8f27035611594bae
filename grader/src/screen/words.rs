//! Words that an answer may not say.

use exercise_runner::tokens::Tokens;

use super::names::{Names, Root};

const FILES: &str = "reads a file while it is compiled, and an answer is compiled without any \
    other file. Write what you need into the answer.";
const ENVIRONMENT: &str = "reads the environment of the compiler, and an answer must not depend \
    on where it is compiled. Write the value itself.";
const ASSEMBLER: &str =
    "is assembler, and an answer runs on a machine of another kind. Write it in Rust.";
const SYMBOL: &str = "changes by what name or at what place the linker finds an item, and the \
    grader calls the functions of an answer by their paths. Leave the attribute out.";
const PROGRAM: &str =
    "replaces a part of the program around the answer, which is the grader's. Leave it out.";
const IN_THE_COMPILER: &str = "makes a macro that runs in the compiler, and an answer runs on its \
    own machine only. Write a function, or a macro with `macro_rules!`.";
const HOOK: &str =
    "changes what happens after a panic, and the grader reads panics itself. Leave it out.";
const LIMIT: &str = "changes a limit or a part of the compiler, and the grader compiles all \
    answers alike. Leave it out.";

/// Words that mean one thing wherever they stand.
const ANYWHERE: &[(&str, &str)] = &[
    (
        "unsafe",
        "is for what the compiler cannot check, and an answer is calculation. Write it in safe \
            Rust.",
    ),
    (
        "extern",
        "leads to foreign code, and there is none around an answer. Use the standard library, \
            nalgebra and vislam.",
    ),
    ("no_mangle", SYMBOL),
    ("export_name", SYMBOL),
    ("link_name", SYMBOL),
    ("link_ordinal", SYMBOL),
    ("link_section", SYMBOL),
    ("global_allocator", PROGRAM),
    ("panic_handler", PROGRAM),
    ("alloc_error_handler", PROGRAM),
    ("proc_macro", IN_THE_COMPILER),
    ("proc_macro_attribute", IN_THE_COMPILER),
    ("proc_macro_derive", IN_THE_COMPILER),
    (
        "macro_export",
        "gives the macro to the program around the answer, which has its own. Leave the attribute \
            out.",
    ),
    ("set_hook", HOOK),
    ("take_hook", HOOK),
    ("update_hook", HOOK),
    (
        "catch_unwind",
        "catches panics, and where answers run a panic ends the call. Ask for the condition \
            before it panics.",
    ),
];

/// Macros with names that nobody gives to anything else.
const MACROS: &[(&str, &str)] = &[
    ("include_str", FILES),
    ("include_bytes", FILES),
    ("option_env", ENVIRONMENT),
    ("global_asm", ASSEMBLER),
    ("naked_asm", ASSEMBLER),
];

/// Macros with names that somebody may give to a variable.
const MACROS_OR_NAMES: &[(&str, &str)] =
    &[("include", FILES), ("env", ENVIRONMENT), ("asm", ASSEMBLER)];

/// Words that mean this in attributes only.
const IN_ATTRIBUTES: &[(&str, &str)] = &[
    ("link", SYMBOL),
    ("used", SYMBOL),
    ("recursion_limit", LIMIT),
    ("type_length_limit", LIMIT),
    ("no_core", LIMIT),
];

/// What it says and may not, with the lines.
pub fn findings(tokens: &Tokens, names: &Names) -> Vec<(usize, String)> {
    let is_loose = (0..tokens.len()).any(|at| is_loose(tokens, at));
    let finding = |at| Some((tokens.line(at), finding(tokens, names, at, is_loose)?));
    (0..tokens.len()).filter_map(finding).collect()
}

fn finding(tokens: &Tokens, names: &Names, at: usize, is_loose: bool) -> Option<String> {
    if tokens.is(at, '$') {
        return built(tokens, at);
    }
    let word = tokens.word(at);
    let why = |table: &[(&str, &'static str)]| {
        table.iter().find(|(name, _)| *name == word).map(|(_, why)| *why)
    };
    if word == "extern" && tokens.keyword(at + 1) == "crate" && is_there(tokens.word(at + 2)) {
        return Some(of_a_crate(tokens, at));
    }
    if let Some(why) = why(ANYWHERE) {
        return Some(format!("`{word}` {why}"));
    }
    if let Some(why) = why(MACROS) {
        return Some(format!("`{word}!` {why}"));
    }
    if let Some(why) = why(MACROS_OR_NAMES) {
        return is_macro(tokens, names, at, is_loose).then(|| format!("`{word}!` {why}"));
    }
    if tokens.place(at).attribute {
        return in_attribute(tokens, at)
            .or_else(|| Some(format!("`#[{word}]` {}", why(IN_ATTRIBUTES)?)));
    }
    (tokens.keyword(at) == "mod").then(|| module(tokens, at)).flatten()
}

/// Whether a word that may be a variable is a macro here, or could become one.
fn is_macro(tokens: &Tokens, names: &Names, at: usize, is_loose: bool) -> bool {
    let place = tokens.place(at);
    let called = tokens.is(at + 1, '!') && tokens.opens(at + 2);
    let named =
        (tokens.follows_path(at) || place.import.is_some()) && names.root(tokens, at) != Root::Own;
    let in_macro = place.rules || place.given && is_loose;
    let hidden = in_macro && !tokens.follows(at, '.') && !tokens.follows(at, '$');
    called || named || hidden
}

/// Whether `!` stands where a macro can put it behind a name that it is given.
fn is_loose(tokens: &Tokens, at: usize) -> bool {
    if !tokens.is(at, '!') || at < 2 {
        return false;
    }
    let behind_a_name = !tokens.word(at - 1).is_empty() && !tokens.is(at - 2, '$');
    let place = tokens.place(at);
    place.given || place.rules && !behind_a_name
}

fn is_there(name: &str) -> bool {
    ["core", "nalgebra", "std", "vislam"].contains(&name)
}

fn of_a_crate(tokens: &Tokens, at: usize) -> String {
    let name = tokens.word(at + 2);
    let sentence = format!("`extern crate`: `{name}` is there without it. Leave the line out");
    match tokens.word(at + 4) {
        other if tokens.keyword(at + 3) == "as" && !other.is_empty() => {
            format!("{sentence}; write `use {name} as {other};`.")
        }
        _ => format!("{sentence}."),
    }
}

/// `path = …` and `feature(…)`; with other marks behind them both are harmless.
fn in_attribute(tokens: &Tokens, at: usize) -> Option<String> {
    match tokens.word(at) {
        "path" if tokens.is(at + 1, '=') => Some(format!("`#[path]` {FILES}")),
        "feature" if tokens.is(at + 1, '(') => Some(format!("`#![feature]` {LIMIT}")),
        _ => None,
    }
}

/// A module that is another file, or could become one in a macro.
fn module(tokens: &Tokens, at: usize) -> Option<String> {
    let place = tokens.place(at);
    let name = if tokens.is(at + 1, '$') { at + 2 } else { at + 1 };
    let has_body = tokens.is(name + 1, '{');
    if place.given || place.rules && !has_body {
        let sentence = "`mod` in a macro can become a module in another file, and each exercise \
            is one file. Write the module without the macro.";
        return Some(sentence.to_owned());
    }
    tokens.is(at + 2, ';').then(|| {
        let name = tokens.word(at + 1);
        format!(
            "`mod {name};` reads another file, and each exercise is one file. Put the content of \
                the module here: `mod {name} {{ … }}`."
        )
    })
}

/// A macro that is called by a name which another macro was given.
fn built(tokens: &Tokens, at: usize) -> Option<String> {
    let called = !tokens.word(at + 1).is_empty() && tokens.is(at + 2, '!') && tokens.opens(at + 3);
    called.then(|| {
        let name = tokens.word(at + 1);
        format!(
            "`${name}!` calls a macro whose name is given to another, so that nobody can see \
                which. Write its name here."
        )
    })
}
