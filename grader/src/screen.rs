//! The source screen: what an answer may not say, with a reason and a way out.
//!
//! It reads tokens and not text, so that raw identifiers, attributes and the insides of macros
//! count, and comments and strings do not. It is a courtesy and no wall: what would get past it
//! meets the list of files that the compiler read, and a machine that has nothing to reach.

mod paths;
mod tokens;
mod words;

use exercise_spec::exercise;

use tokens::Tokens;

/// How many findings are told.
const TOLD: usize = 5;

/// Looks at an answer.
///
/// # Errors
///
/// What it may not say, one finding a line: the line of the file, what stands there, why it may
/// not, and what to do instead.
pub fn screen(slug: &str, text: &str) -> Result<(), String> {
    let tokens = Tokens::of(text)?;
    let mut findings: Vec<(usize, String)> = words::findings(&tokens);
    findings.extend(paths::findings(&tokens));
    findings.extend(exercise(slug).into_iter().flat_map(|it| forbidden(&tokens, it.forbidden)));
    findings.sort();
    findings.dedup();
    let others = findings.len().saturating_sub(TOLD);
    findings.truncate(TOLD);
    let mut lines: Vec<String> =
        findings.into_iter().map(|(line, sentence)| format!("line {line}: {sentence}")).collect();
    if others > 0 {
        lines.push(format!("and {others} more of the kind"));
    }
    if lines.is_empty() { Ok(()) } else { Err(lines.join("\n")) }
}

/// Items of the library that are the answer. What the answer calls so itself is no such item.
fn forbidden(tokens: &Tokens, items: &[&str]) -> Vec<(usize, String)> {
    let reaches = |at: &usize| {
        let name = tokens.word(*at);
        items.contains(&name) && is_the_librarys(tokens, *at, name)
    };
    let sentence = |at: usize| {
        let name = tokens.word(at);
        let sentence = format!(
            "`{name}` of the library does what this exercise asks for. Write it yourself, of the \
                parts that its page names."
        );
        (tokens.line(at), sentence)
    };
    (0..tokens.len()).filter(reaches).map(sentence).collect()
}

fn is_the_librarys(tokens: &Tokens, at: usize, name: &str) -> bool {
    if tokens.in_import(at) {
        return true;
    }
    let called = tokens.is(at + 1, '(') || tokens.separates(at + 1);
    if tokens.follows_path(at) {
        let owner = tokens.word(at.saturating_sub(3));
        return !matches!(owner, "Self" | "self" | "super") && !tokens.defines(owner);
    }
    if tokens.defines(name) {
        return false;
    }
    if at > 0 && tokens.is(at - 1, '.') {
        return called;
    }
    let is_type = name.starts_with(char::is_uppercase);
    tokens.has_foreign_glob() && (called || is_type)
}
