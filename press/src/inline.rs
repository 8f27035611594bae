//! The marks inside a paragraph: references, citations, computed values, mathematics, code.

use std::collections::HashMap;
use std::sync::LazyLock;

use regex::Regex;

use crate::attributes::Attributes;

/// A piece of a paragraph, with the byte at which it begins.
#[derive(Debug, PartialEq)]
pub struct Token<'a> {
    /// Offset in the paragraph.
    pub at: usize,
    /// What it is.
    pub mark: Mark<'a>,
}

/// The marks of a paragraph.
#[derive(Debug, PartialEq)]
pub enum Mark<'a> {
    /// Text that is passed on.
    Plain(&'a str),
    /// A code span with its backticks.
    Code(&'a str),
    /// The TeX between two dollar signs.
    Math(&'a str),
    /// `{{value chapter.name}}`.
    Value(&'a str),
    /// Any other `{{…}}`.
    Directive(&'a str),
    /// `@eq:label`, or `[-@eq:label]` for the number alone.
    Reference { label: &'a str, bare: bool },
    /// `[@key; @other]`, or `@key` as part of the sentence.
    Citation { keys: Vec<&'a str>, narrative: bool },
    /// `[text](api:path::of::item)`.
    Item { text: &'a str, path: &'a str },
    /// `[text]{.class}`.
    Span { text: &'a str, attributes: Attributes },
    /// A dollar sign that begins mathematics which never ends.
    UnclosedMath,
    /// `$$` in the middle of a paragraph.
    MisplacedDisplay,
    /// A bracket around more than [`DEEPEST`] others, one in the other.
    Nested,
}

/// A label that a comment in code names, as in `Implements {eq:projection}`.
pub static NAMED_LABEL: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r"\{((?:alg|eq|fig|lst|sec|thm):[\w-]+)\}").expect("a valid pattern")
});

/// Works that a comment in code names, as in `[@triggs2000]` or `([@a; @b])`, with the parenthesis before them.
pub static NAMED_WORKS: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r"(\(?)\[@([\w-]+(?:; @[\w-]+)*)\]|@([\w-]+)").expect("a valid pattern")
});

/// The kinds of labels that can be referred to.
pub const LABEL_KINDS: [&str; 6] = ["alg:", "eq:", "fig:", "lst:", "sec:", "thm:"];

/// So many brackets may stand one in the other: what is inside of a mark is read once more for each around it.
pub const DEEPEST: usize = 8;

/// Splits a paragraph into its marks.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let pairs = pairs(text);
    let mut tokens = Vec::new();
    let mut plain = 0;
    let mut at = 0;
    while at < text.len() {
        let (mark, length) = match mark(text, at, &pairs) {
            Some(found) => found,
            None => {
                at += step(&text[at..]);
                continue;
            }
        };
        if plain < at {
            tokens.push(Token { at: plain, mark: Mark::Plain(&text[plain..at]) });
        }
        tokens.push(Token { at, mark });
        at += length;
        plain = at;
    }
    if plain < text.len() {
        tokens.push(Token { at: plain, mark: Mark::Plain(&text[plain..]) });
    }
    tokens
}

/// The bytes to pass over where no mark begins: an escaped character counts as one step.
fn step(rest: &str) -> usize {
    let mut characters = rest.chars();
    let first = characters.next().map_or(1, char::len_utf8);
    match rest.starts_with('\\') {
        true => first + characters.next().map_or(0, char::len_utf8),
        false => first,
    }
}

/// A bracket that is closed.
struct Pair {
    /// Where it is closed.
    end: usize,
    /// How many stand one in the other, itself among them.
    height: usize,
}

/// Each bracket that is closed, by where it is opened.
fn pairs(text: &str) -> HashMap<usize, Pair> {
    let (mut open, mut pairs) = (Vec::<(usize, usize)>::new(), HashMap::new());
    for (end, byte) in text.bytes().enumerate() {
        match byte {
            b'[' => open.push((end, 1)),
            b']' => {
                let Some((begin, height)) = open.pop() else { continue };
                if let Some((_, around)) = open.last_mut() {
                    *around = (*around).max(height + 1);
                }
                pairs.insert(begin, Pair { end, height });
            }
            _ => {}
        }
    }
    pairs
}

fn mark<'a>(text: &'a str, at: usize, pairs: &HashMap<usize, Pair>) -> Option<(Mark<'a>, usize)> {
    let rest = &text[at..];
    match rest.as_bytes()[0] {
        b'`' => code(rest),
        b'$' => Some(math(rest)),
        b'{' => braces(rest),
        b'[' => match pairs.get(&at)? {
            Pair { height, .. } if *height > DEEPEST => Some((Mark::Nested, 1)),
            Pair { end, .. } => bracket(rest, end - at),
        },
        b'@' if !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '.') => at_sign(rest),
        _ => None,
    }
}

fn code(rest: &str) -> Option<(Mark<'_>, usize)> {
    let ticks = rest.len() - rest.trim_start_matches('`').len();
    let fence = &rest[..ticks];
    let mut from = ticks;
    while let Some(found) = rest[from..].find(fence) {
        let end = from + found + ticks;
        if !rest[end..].starts_with('`') {
            return Some((Mark::Code(&rest[..end]), end));
        }
        from = end + (rest[end..].len() - rest[end..].trim_start_matches('`').len());
    }
    Some((Mark::Plain(fence), ticks))
}

fn math(rest: &str) -> (Mark<'_>, usize) {
    if rest.starts_with("$$") {
        return (Mark::MisplacedDisplay, 2);
    }
    let body = &rest[1..];
    let paragraph = body.find("\n\n").unwrap_or(body.len());
    let mut from = 0;
    while let Some(found) = body[from..paragraph].find('$') {
        let end = from + found;
        let slashes = body[..end].len() - body[..end].trim_end_matches('\\').len();
        if slashes.is_multiple_of(2) {
            return (Mark::Math(&body[..end]), end + 2);
        }
        from = end + 1;
    }
    (Mark::UnclosedMath, 1)
}

fn braces(rest: &str) -> Option<(Mark<'_>, usize)> {
    let body = rest.strip_prefix("{{")?;
    let end = body.find("}}")?;
    let inside = body[..end].trim();
    let mark = match inside.split_once(char::is_whitespace) {
        Some(("value", name)) => Mark::Value(name.trim()),
        _ => Mark::Directive(inside),
    };
    Some((mark, end + 4))
}

/// What begins with a bracket that is closed `end` bytes behind it.
fn bracket(rest: &str, end: usize) -> Option<(Mark<'_>, usize)> {
    let length = end + 1;
    let (inside, after) = (&rest[1..end], &rest[length..]);
    if let Some(label) = inside.strip_prefix("-@") {
        return Some((Mark::Reference { label, bare: true }, length));
    }
    if inside.starts_with('@') && !LABEL_KINDS.iter().any(|kind| inside[1..].starts_with(kind)) {
        let keys = inside.split(';').map(|key| key.trim().trim_start_matches('@')).collect();
        return Some((Mark::Citation { keys, narrative: false }, length));
    }
    if let Some((path, after)) = after.strip_prefix("(api:").and_then(|rest| rest.split_once(')')) {
        return Some((Mark::Item { text: inside, path }, rest.len() - after.len()));
    }
    let (attributes, taken) = Attributes::parse(after)?;
    Some((Mark::Span { text: inside, attributes }, length + taken))
}

fn at_sign(rest: &str) -> Option<(Mark<'_>, usize)> {
    let body = &rest[1..];
    let word = |text: &str| {
        let end = text
            .find(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_'))
            .unwrap_or(text.len());
        text[..end].trim_end_matches(['-', '_']).len()
    };
    for kind in LABEL_KINDS {
        if let Some(name) = body.strip_prefix(kind) {
            let length = kind.len() + word(name);
            return Some((Mark::Reference { label: &body[..length], bare: false }, length + 1));
        }
    }
    let length = word(body);
    (length > 0)
        .then(|| (Mark::Citation { keys: vec![&body[..length]], narrative: true }, length + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(text: &str) -> Vec<Mark<'_>> {
        tokens(text).into_iter().map(|token| token.mark).collect()
    }

    #[test]
    fn references_citations_and_values_are_found() {
        assert_eq!(
            marks("By @eq:pose-block, see [@forster2017; @triggs2000]."),
            [
                Mark::Plain("By "),
                Mark::Reference { label: "eq:pose-block", bare: false },
                Mark::Plain(", see "),
                Mark::Citation { keys: vec!["forster2017", "triggs2000"], narrative: false },
                Mark::Plain("."),
            ]
        );
        assert_eq!(marks("{{value bearing.fx}}"), [Mark::Value("bearing.fx")]);
        assert_eq!(marks("{{value\nbearing.fx }}"), [Mark::Value("bearing.fx")]);
        assert_eq!(marks("[-@fig:rays]"), [Mark::Reference { label: "fig:rays", bare: true }]);
    }

    #[test]
    fn a_link_to_an_item_keeps_its_text() {
        assert_eq!(
            marks("[`exp`](api:so3::exp) of [x](a.md)"),
            [Mark::Item { text: "`exp`", path: "so3::exp" }, Mark::Plain(" of [x](a.md)")]
        );
    }

    #[test]
    fn code_and_mathematics_hide_marks() {
        assert_eq!(marks("``@eq:a ` b``"), [Mark::Code("``@eq:a ` b``")]);
        assert_eq!(marks(r"$a_\$ @x$"), [Mark::Math(r"a_\$ @x")]);
        assert_eq!(marks(r"\$5 and \@x"), [Mark::Plain(r"\$5 and \@x")]);
    }

    #[test]
    fn a_span_may_hold_mathematics_with_brackets() {
        let found = marks("[the skew $[t]_\\times$]{.estimated}");
        assert!(
            matches!(&found[..], [Mark::Span { text: "the skew $[t]_\\times$", .. }]),
            "{found:?}"
        );
    }

    #[test]
    fn a_bracket_around_too_many_others_is_told_and_what_is_inside_is_read() {
        let inside =
            format!("{}[x]{{.measured}}{}", "[".repeat(DEEPEST - 1), "]".repeat(DEEPEST - 1));
        assert!(!marks(&inside).contains(&Mark::Nested));
        let one_more = format!("[{inside}]");
        let found = marks(&one_more);
        assert_eq!(found.iter().filter(|mark| **mark == Mark::Nested).count(), 1);
        assert!(found.iter().any(|mark| matches!(mark, Mark::Span { text: "x", .. })), "{found:?}");
        assert!(!marks(&"[a] [b] ".repeat(DEEPEST)).contains(&Mark::Nested));
    }

    #[test]
    fn an_address_is_not_a_citation() {
        assert_eq!(marks("me@example.org"), [Mark::Plain("me@example.org")]);
    }
}
