//! What is around the tokens of an answer: attributes, imports, macros, modules and tests.

use std::collections::BTreeSet;

use super::Tokens;

/// What is around a token.
#[derive(Debug, Clone, Copy, Default)]
pub struct Place {
    /// It is part of an attribute.
    pub attribute: bool,
    /// It is part of a `use`, of a path that begins here.
    pub import: Option<usize>,
    /// It is part of the rules of a macro.
    pub rules: bool,
    /// It is given to a macro that may be one of the file, which does with it what it likes.
    pub given: bool,
    /// In how many modules of the file it is.
    pub modules: usize,
    /// It is part of an item for tests, which is not compiled.
    pub test: bool,
}

impl Place {
    /// Whether a macro of the file may put it elsewhere.
    pub fn in_macro(&self) -> bool {
        self.rules || self.given
    }
}

/// Macros that leave what they are given where it is.
const KNOWN: &[&str] = &[
    "assert",
    "assert_eq",
    "assert_ne",
    "concat",
    "dbg",
    "debug_assert",
    "debug_assert_eq",
    "debug_assert_ne",
    "dmatrix",
    "dvector",
    "eprint",
    "eprintln",
    "format",
    "format_args",
    "matches",
    "matrix",
    "panic",
    "point",
    "print",
    "println",
    "stack",
    "stringify",
    "thread_local",
    "todo",
    "unimplemented",
    "unreachable",
    "vec",
    "vector",
    "write",
    "writeln",
];

/// As many attributes of an item for tests are read.
const ATTRIBUTES: usize = 20;

/// Words after which `!` means “not”.
const NO_MACROS: &[&str] =
    &["as", "break", "else", "if", "in", "let", "match", "move", "mut", "return", "while"];

/// Finds the places of all tokens.
pub fn mark(tokens: &mut Tokens) {
    let made = made(tokens);
    let mut around = vec![Place::default()];
    for at in 0..tokens.len() {
        if tokens.closes(at) && around.len() > 1 {
            around.pop();
        }
        let place = around.last().copied().unwrap_or_default();
        tokens.list[at].place = place;
        if tokens.opens(at) {
            around.push(inside(tokens, at, place, &made));
        }
    }
    mark_imports(tokens);
    mark_tests(tokens);
}

/// Names that the file gives to macros, or may. “$” stands for any, and `macro_rules` is there when
/// it makes macros at all.
fn made(tokens: &Tokens) -> BTreeSet<String> {
    let mut made = BTreeSet::new();
    for at in 0..tokens.len() {
        let name = match tokens.word(at) {
            "macro_rules" => at + 2,
            "as" => at + 1,
            _ => continue,
        };
        made.insert(tokens.word(at).to_owned());
        made.insert(if tokens.is(name, '$') { "$" } else { tokens.word(name) }.to_owned());
    }
    made
}

/// The place inside a bracket that opens here.
fn inside(tokens: &Tokens, open: usize, around: Place, made: &BTreeSet<String>) -> Place {
    let before = |back: usize| open.checked_sub(back).unwrap_or(usize::MAX);
    let is = |back: usize, mark: char| tokens.is(before(back), mark);
    let attribute = tokens.is(open, '[') && (is(1, '#') || is(1, '!') && is(2, '#'));
    let rules = is(2, '!') && tokens.keyword(before(3)) == "macro_rules";
    let of_rust = KNOWN.contains(&tokens.word(before(2))) && !made.contains("$");
    let known = of_rust && !made.contains(tokens.word(before(2)));
    let called = made.contains("macro_rules")
        && is(1, '!')
        && !tokens.word(before(2)).is_empty()
        && !NO_MACROS.contains(&tokens.keyword(before(2)));
    let named = if is(2, '$') { before(3) } else { before(2) };
    let module = tokens.is(open, '{')
        && !tokens.word(before(1)).is_empty()
        && tokens.keyword(named) == "mod"
        // A macro may take what is in the module out of it.
        && !around.given;
    // The rules of a macro stand wherever it is called.
    let modules = if rules { 0 } else { around.modules + usize::from(module) };
    Place {
        attribute: around.attribute || attribute,
        rules: around.rules || rules,
        given: around.given || called && !known,
        modules,
        ..around
    }
}

fn mark_imports(tokens: &mut Tokens) {
    let mut at = 0;
    while at < tokens.len() {
        // `use<…>` among the bounds of a type is no import.
        if tokens.keyword(at) == "use" && !tokens.is(at + 1, '<') {
            at = mark_import(tokens, at);
        }
        at += 1;
    }
}

/// Marks an import, and gives its end.
fn mark_import(tokens: &mut Tokens, begin: usize) -> usize {
    let (mut path, mut around) = (None, Vec::new());
    let mut at = begin;
    while at < tokens.len() && !tokens.is(at, ';') {
        if tokens.opens(at) {
            around.push(path);
        } else if tokens.closes(at) {
            around.pop();
        } else if tokens.is(at, ',') {
            path = around.last().copied().flatten();
        } else if at > begin && path.is_none() && !tokens.word(at).is_empty() {
            path = Some(at);
        }
        tokens.list[at].place.import = Some(path.unwrap_or(at));
        at += 1;
    }
    at
}

fn mark_tests(tokens: &mut Tokens) {
    for at in 0..tokens.len() {
        let begins = is_for_tests(tokens, at) && !tokens.place(at).test;
        let end = if begins { item_end(tokens, at + 7) } else { None };
        for token in &mut tokens.list[at..end.unwrap_or(at)] {
            token.place.test = true;
        }
    }
}

/// Whether `#[cfg(test)]` stands here, and no macro could take it away.
fn is_for_tests(tokens: &Tokens, at: usize) -> bool {
    tokens.is(at, '#')
        && tokens.is(at + 1, '[')
        && tokens.keyword(at + 2) == "cfg"
        && tokens.is(at + 3, '(')
        && tokens.keyword(at + 4) == "test"
        && tokens.is(at + 5, ')')
        && tokens.is(at + 6, ']')
        && !tokens.place(at).in_macro()
}

/// Where an item ends that begins here, if nothing but an item can begin so. It is never too far.
fn item_end(tokens: &Tokens, begin: usize) -> Option<usize> {
    let mut at = begin;
    for _ in 0..ATTRIBUTES {
        if tokens.is(at, '#') && tokens.is(at + 1, '[') {
            at = behind(tokens, at + 1);
        }
    }
    if tokens.keyword(at) == "pub" {
        at = if tokens.is(at + 1, '(') { behind(tokens, at + 1) } else { at + 1 };
    }
    let word = tokens.keyword(at);
    let is_function = word == "fn" && !tokens.word(at + 1).is_empty();
    if !is_function && !["enum", "impl", "mod", "struct", "trait", "use"].contains(&word) {
        return None;
    }
    let has_body = word != "use";
    while at < tokens.len() && !tokens.is(at, ';') && !tokens.closes(at) {
        if tokens.opens(at) {
            let is_body = has_body && tokens.is(at, '{');
            at = behind(tokens, at);
            if is_body {
                return Some(at);
            }
        } else {
            at += 1;
        }
    }
    Some(at)
}

/// The place behind a bracket that opens here.
fn behind(tokens: &Tokens, open: usize) -> usize {
    let mut depth = 0_usize;
    for at in open..tokens.len() {
        depth += usize::from(tokens.opens(at));
        depth -= usize::from(tokens.closes(at));
        if depth == 0 {
            return at + 1;
        }
    }
    tokens.len()
}
