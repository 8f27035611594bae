//! The marks inside a paragraph: references, citations, computed values, mathematics, code.

use std::collections::HashMap;
use std::sync::LazyLock;

use regex::Regex;

use crate::attributes::Attributes;

/// A piece of a paragraph, and where it begins.
#[derive(Debug, PartialEq)]
pub struct Token<'a> {
    /// Offset in the paragraph.
    pub at: usize,
    /// How many lines of the paragraph end before it.
    pub line: usize,
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
    /// `{{` that is never closed.
    UnclosedBraces,
    /// Braces behind a bracket that are no attributes.
    NoAttributes,
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
    let ends = Ends::of(text);
    let mut tokens = Vec::<Token<'_>>::new();
    let mut push = |at: usize, mark| {
        let before = tokens.last().map_or((0, 0), |token| (token.at, token.line));
        let line = before.1 + text[before.0..at].matches('\n').count();
        tokens.push(Token { at, line, mark });
    };
    let mut plain = 0;
    let mut at = 0;
    while at < text.len() {
        let (mark, length) = match mark(text, at, &ends) {
            Some(found) => found,
            None => {
                at += step(&text[at..]);
                continue;
            }
        };
        if plain < at {
            push(plain, Mark::Plain(&text[plain..at]));
        }
        push(at, mark);
        at += length;
        plain = at;
    }
    if plain < text.len() {
        push(plain, Mark::Plain(&text[plain..]));
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

/// Where marks of a paragraph may end: found once, since a search from each beginning takes the square of the length.
struct Ends {
    /// Each bracket that is closed, by where it is opened.
    pairs: HashMap<usize, Pair>,
    /// Where backticks begin of which so many, and no more, stand in a row.
    fences: HashMap<usize, Vec<usize>>,
    /// Where paragraphs end at an empty line.
    paragraphs: Vec<usize>,
    /// Where `}}` stands.
    braces: Vec<usize>,
}

impl Ends {
    fn of(text: &str) -> Ends {
        let all = |end| text.match_indices(end).map(|(at, _)| at).collect();
        let (paragraphs, braces) = (all("\n\n"), all("}}"));
        Ends { pairs: pairs(text), fences: fences(text), paragraphs, braces }
    }
}

/// The first of some places, in order, that is not before another.
fn first(places: &[usize], from: usize) -> Option<usize> {
    places.get(places.partition_point(|&place| place < from)).copied()
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

/// Each row of backticks, by how many they are.
fn fences(text: &str) -> HashMap<usize, Vec<usize>> {
    let mut fences = HashMap::<usize, Vec<usize>>::new();
    let mut at = 0;
    while let Some(found) = text[at..].find('`') {
        let ticks = ticks(&text[at + found..]);
        fences.entry(ticks).or_default().push(at + found);
        at += found + ticks;
    }
    fences
}

/// How many backticks stand at the beginning.
fn ticks(rest: &str) -> usize {
    rest.len() - rest.trim_start_matches('`').len()
}

fn mark<'a>(text: &'a str, at: usize, ends: &Ends) -> Option<(Mark<'a>, usize)> {
    let rest = &text[at..];
    match rest.as_bytes()[0] {
        b'`' => Some(code(text, at, &ends.fences)),
        b'$' => Some(math(rest, first(&ends.paragraphs, at).map(|end| end - at))),
        b'{' => braces(rest, first(&ends.braces, at).map(|end| end - at)),
        b'[' => match ends.pairs.get(&at)? {
            Pair { height, .. } if *height > DEEPEST => Some((Mark::Nested, 1)),
            Pair { end, .. } => bracket(rest, end - at),
        },
        b'@' if !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '.') => at_sign(rest),
        _ => None,
    }
}

fn code<'a>(text: &'a str, at: usize, fences: &HashMap<usize, Vec<usize>>) -> (Mark<'a>, usize) {
    let ticks = ticks(&text[at..]);
    let inside = at + ticks;
    match fences.get(&ticks).and_then(|begins| first(begins, inside)) {
        Some(begin) => (Mark::Code(&text[at..begin + ticks]), begin + ticks - at),
        None => (Mark::Plain(&text[at..inside]), ticks),
    }
}

/// What begins with a dollar sign in a paragraph that ends so many bytes behind it, or with the text.
fn math(rest: &str, paragraph: Option<usize>) -> (Mark<'_>, usize) {
    if rest.starts_with("$$") {
        return (Mark::MisplacedDisplay, 2);
    }
    let body = &rest[1..paragraph.unwrap_or(rest.len())];
    let mut from = 0;
    while let Some(found) = body[from..].find('$') {
        let end = from + found;
        let slashes = body[..end].len() - body[..end].trim_end_matches('\\').len();
        if slashes.is_multiple_of(2) {
            return (Mark::Math(&body[..end]), end + 2);
        }
        from = end + 1;
    }
    (Mark::UnclosedMath, 1)
}

/// What begins with a brace, where `}}` stands next so many bytes behind it.
fn braces(rest: &str, end: Option<usize>) -> Option<(Mark<'_>, usize)> {
    rest.strip_prefix("{{")?;
    let Some(end) = end else { return Some((Mark::UnclosedBraces, 2)) };
    let inside = rest[2..end].trim();
    let mark = match inside.split_once(char::is_whitespace) {
        Some(("value", name)) => Mark::Value(name.trim()),
        _ => Mark::Directive(inside),
    };
    Some((mark, end + 2))
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
    match Attributes::parse(after) {
        Some((attributes, taken)) => {
            Some((Mark::Span { text: inside, attributes }, length + taken))
        }
        None => {
            (after.starts_with('{') && !after.starts_with("{{")).then_some((Mark::NoAttributes, 1))
        }
    }
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
