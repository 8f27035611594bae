//! Whose a name is: the file's own, or that of a library.

use std::collections::BTreeSet;

use exercise_runner::tokens::Tokens;

/// As many parts of a path are followed. None is so long.
const SEGMENTS: usize = 100;

/// What a file calls by names.
#[derive(Debug, Default)]
pub struct Names {
    functions: BTreeSet<String>,
    types: BTreeSet<String>,
    modules: BTreeSet<String>,
    /// Every word in an import of something foreign.
    imported: BTreeSet<String>,
    /// Whether everything is imported of a module that is not the file's.
    pub all_of_foreign: bool,
    /// Whether it may be one of vislam.
    pub all_of_vislam: bool,
}

/// Where a path begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Root {
    Own,
    Foreign,
    Unknown,
}

/// Keywords that `::` may follow without a path before it.
const BEFORE_ABSOLUTE: &[&str] = &[
    "as", "break", "dyn", "else", "for", "if", "impl", "in", "match", "move", "mut", "return",
    "use", "where", "while",
];

impl Names {
    /// Those of a file. Macros and tests make none: they need not come to be.
    pub fn of(tokens: &Tokens) -> Self {
        let mut names = Self::default();
        for at in 1..tokens.len() {
            let place = tokens.place(at);
            let of_kind = match tokens.keyword(at - 1) {
                "fn" => &mut names.functions,
                "struct" | "enum" | "union" | "trait" => &mut names.types,
                "mod" => &mut names.modules,
                _ => continue,
            };
            if !place.in_macro() && !place.test && !tokens.word(at).is_empty() {
                of_kind.insert(tokens.word(at).to_owned());
            }
        }
        names.look_at_imports(tokens);
        names
    }

    /// Whether the file has an item of this name.
    fn has(&self, name: &str) -> bool {
        self.functions.contains(name) || self.types.contains(name) || self.modules.contains(name)
    }

    /// Where a path begins that leads to this word.
    pub fn root(&self, tokens: &Tokens, at: usize) -> Root {
        let first = first(tokens, at);
        let absolute = tokens.follows_path(first);
        if absolute && first >= 3 && tokens.is(first - 3, '>') {
            return Root::Unknown;
        }
        match tokens.word(first) {
            _ if absolute => Root::Foreign,
            "self" | "Self" | "super" | "crate" => Root::Own,
            "vislam" | "nalgebra" | "exercise_spec" | "std" | "core" => Root::Foreign,
            name if self.has(name) => Root::Own,
            name if self.imported.contains(name) => Root::Foreign,
            _ if tokens.place(at).import.is_some() => Root::Foreign,
            _ => Root::Unknown,
        }
    }

    fn look_at_imports(&mut self, tokens: &Tokens) {
        let imports = (0..tokens.len()).filter(|at| tokens.place(*at).import.is_some());
        for at in imports {
            if tokens.is(at, '*') && self.root(tokens, at) != Root::Own {
                self.all_of_foreign = true;
                let from = tokens.word(first(tokens, at));
                self.all_of_vislam |= !["nalgebra", "std", "core"].contains(&from);
            }
            if !tokens.keyword(at).is_empty() && self.root(tokens, at) == Root::Foreign {
                self.imported.insert(tokens.word(at).to_owned());
            }
        }
    }
}

/// The first word of the path that leads to a place.
fn first(tokens: &Tokens, at: usize) -> usize {
    if let Some(first) = tokens.place(at).import {
        return first;
    }
    let mut first = at;
    for _ in 0..SEGMENTS {
        if tokens.follows_path(first) && first >= 3 && is_segment(tokens, first - 3) {
            first -= 3;
        }
    }
    first
}

fn is_segment(tokens: &Tokens, at: usize) -> bool {
    !tokens.word(at).is_empty() && !BEFORE_ABSOLUTE.contains(&tokens.keyword(at))
}
