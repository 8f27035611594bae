//! A chapter's Markdown as the blocks that the press cares about.
//!
//! Everything else stays text and reaches mdBook untouched.

use std::sync::LazyLock;

use regex::Regex;

use crate::attributes::Attributes;

/// A piece of a chapter that begins on a line of its own.
#[derive(Debug, PartialEq)]
pub struct Block {
    /// The line it begins on, counted from 1.
    pub line: usize,
    /// The white space before it, kept so that blocks in lists stay in their lists.
    pub indent: String,
    /// The number that the book gives it, `1.2`; empty where it has none.
    pub number: String,
    /// The line of the heading that leads into depth, where the block is off the main road.
    pub depth: Option<usize>,
    /// What it is.
    pub kind: Kind,
}

/// The kinds of blocks.
#[derive(Debug, PartialEq)]
pub enum Kind {
    /// Prose and whatever else is passed on; inline marks in it are still to be resolved.
    Text(String),
    /// `## Title {#sec:label}`.
    Heading { level: usize, title: String, attributes: Attributes },
    /// `$$ … $$ {#eq:label}`, and the line its TeX begins on.
    Equation { tex: String, attributes: Attributes, tex_line: usize },
    /// `![caption](chapter/name.svg){#fig:label alt="…"}`.
    Figure { caption: String, path: String, attributes: Attributes },
    /// A fenced code block: ```` ```language ```` or ```` ```{.language #lst:label caption="…"} ````.
    Fence { language: String, attributes: Attributes, body: Vec<String> },
    /// Code by indentation, which the book does not use.
    IndentedCode(String),
    /// `::: {.class}` or `::: class`.
    Open(Attributes),
    /// `:::`.
    Close,
    /// `- [ ] …`, or `- [x] …` for the right one, in a prediction.
    Choice { right: bool, text: String },
    /// `1. What is done. {.step code="…"}`: a line of an algorithm.
    Step { number: usize, text: String, attributes: Attributes },
    /// What stands on the last line of a comment behind it.
    AfterComment(String),
    /// Something that was opened and never closed, in a few words.
    Unclosed(&'static str),
}

impl Block {
    /// What is read of it: prose, captions, choices and titles.
    pub fn said(&self) -> &str {
        match &self.kind {
            Kind::Text(text) | Kind::Choice { text, .. } | Kind::Step { text, .. } => text,
            Kind::Figure { caption, .. } => caption,
            Kind::Heading { title, .. } => title,
            _ => "",
        }
    }
}

impl Kind {
    /// A class or a key that means nothing here, and those that do.
    pub fn unknown(&self) -> Option<(&str, String)> {
        let (attributes, classes, keys): (_, &[&str], &[&str]) = match self {
            Kind::Heading { attributes, .. } => {
                (attributes, &["depth"], &["establishes", "part-of", "subtitle"])
            }
            Kind::Equation { attributes, .. } => (attributes, &["definition"], &[]),
            Kind::Figure { attributes, .. } => (attributes, &[], &["alt", "widget"]),
            Kind::Step { attributes, .. } => (attributes, &["step"], &["code", "of"]),
            Kind::Fence { attributes, .. } => (attributes, &[], &["caption"]),
            Kind::Open(attributes) => (attributes, &[], &DIVISION_KEYS),
            _ => return None,
        };
        // The first class of these is a language, or what the division is.
        let own = usize::from(matches!(self, Kind::Fence { .. } | Kind::Open(_)));
        let mut others = attributes.classes.iter().skip(own).map(String::as_str);
        let class = others.find(|class| !classes.contains(class));
        let unknown = class.or_else(|| attributes.key_beyond(keys))?;
        let dotted = classes.iter().map(|class| format!(".{class}"));
        let known: Vec<_> = dotted.chain(keys.iter().map(|key| format!("{key}="))).collect();
        Some((unknown, known.join(", ")))
    }
}

/// What can be said of a division.
const DIVISION_KEYS: [&str; 7] = ["difficulty", "item", "needs", "of", "text", "title", "without"];

/// What stands in a paragraph for each line of a comment, so that the lines below it are counted as they are.
pub const COMMENT: &str = "\u{c}";

/// A text as it is written: without what stands for comments.
pub fn without_comments(text: &str) -> String {
    text.replace(&format!("{COMMENT}\n"), "")
}

/// Braces at a heading that begin as attributes do.
static BEGUN: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"\s\{(?:[#.]|\w.*\}$)").expect("a valid pattern"));

/// Splits a chapter into blocks.
pub fn blocks(chapter: &str) -> Vec<Block> {
    let mut reader =
        Reader { lines: chapter.lines().collect(), at: 0, blocks: Vec::new(), text: None };
    while reader.at < reader.lines.len() {
        reader.next_block();
    }
    reader.end_text();
    reader.blocks
}

struct Reader<'a> {
    lines: Vec<&'a str>,
    at: usize,
    blocks: Vec<Block>,
    text: Option<(usize, String)>,
}

impl Reader<'_> {
    fn next_block(&mut self) {
        let line = self.lines[self.at];
        let start = line.trim_start();
        if start.starts_with("```") || start.starts_with("~~~") {
            self.fence();
        } else if start.starts_with("$$") {
            self.equation();
        } else if start.starts_with("![") {
            self.figure();
        } else if start.starts_with(":::") {
            self.div();
        } else if start.starts_with("<!--") {
            self.comment();
        } else if self.is_heading(line) {
            self.heading();
        } else if start.starts_with("- [ ] ") || start.starts_with("- [x] ") {
            self.choice();
        } else if let Some((step, length)) = self.step() {
            self.push(self.at, step);
            self.at += length;
        } else if line.starts_with("    ") && self.after_blank() && !self.in_list() {
            let code = line.to_owned();
            self.push(self.at, Kind::IndentedCode(code));
            self.at += 1;
        } else {
            let text = self.text.get_or_insert((self.at, String::new()));
            text.1.push_str(line);
            text.1.push('\n');
            self.at += 1;
        }
    }

    fn push(&mut self, at: usize, kind: Kind) {
        self.end_text();
        let line = self.lines[at];
        let indent = line[..line.len() - line.trim_start().len()].to_owned();
        self.blocks.push(Block { line: at + 1, indent, number: String::new(), depth: None, kind });
    }

    fn end_text(&mut self) {
        if let Some((at, text)) = self.text.take() {
            let (indent, number) = (String::new(), String::new());
            self.blocks.push(Block {
                line: at + 1,
                indent,
                number,
                depth: None,
                kind: Kind::Text(text),
            });
        }
    }

    fn after_blank(&self) -> bool {
        self.at == 0 || self.lines[self.at - 1].trim().is_empty()
    }

    /// Whether the text above at the margin is an item of a list, so that indentation continues it.
    fn in_list(&self) -> bool {
        let above = self.lines[..self.at].iter().rev();
        let mut margin = above.filter(|line| !line.trim().is_empty() && !line.starts_with("  "));
        margin.next().is_some_and(|line| {
            let mark = line.trim_start_matches(|c: char| c.is_ascii_digit());
            line.starts_with("- ")
                || line.starts_with("* ")
                || mark.starts_with(". ")
                || line.starts_with(": ")
        })
    }

    fn is_heading(&self, line: &str) -> bool {
        let marks = line.len() - line.trim_start_matches('#').len();
        (1..=6).contains(&marks) && line[marks..].starts_with(' ')
    }

    fn heading(&mut self) {
        let line = self.lines[self.at];
        let level = line.len() - line.trim_start_matches('#').len();
        let text = line[level..].trim();
        let tail = |(at, _)| Some((at, Attributes::whole(&text[at + 1..])?));
        let kind = match text.match_indices(" {").find_map(tail) {
            None if BEGUN.is_match(text) => {
                Kind::Unclosed("the list of a heading's attributes ({#sec:name .depth key=\"…\"})")
            }
            found => {
                let (end, attributes) = found.unwrap_or((text.len(), Attributes::default()));
                Kind::Heading { level, title: text[..end].trim().to_owned(), attributes }
            }
        };
        self.push(self.at, kind);
        self.at += 1;
    }

    fn fence(&mut self) {
        let first = self.at;
        let open = self.lines[first].trim_start();
        let mark = &open[..open.len() - open.trim_start_matches(&open[..1]).len()];
        let indent = self.lines[first].len() - open.len();
        let ends = |line: &&str| {
            line.trim().starts_with(mark) && line.trim().trim_start_matches(&mark[..1]).is_empty()
        };
        let Some(length) = self.lines[first + 1..].iter().position(ends) else {
            self.push(first, Kind::Unclosed("a code block"));
            self.at = self.lines.len();
            return;
        };
        let body = self.lines[first + 1..first + 1 + length]
            .iter()
            .map(|line| outdented(line, indent).to_owned())
            .collect();
        let info = open[mark.len()..].trim();
        let kind = match Attributes::whole(info) {
            None if info.contains('{') => Kind::Unclosed(
                "the list of a listing's attributes ({.rust #lst:name caption=\"…\"})",
            ),
            attributes => {
                let attributes = attributes.unwrap_or_default();
                let word = info.split([',', ' ', '{']).next().unwrap_or_default();
                let language = attributes.classes.first().map_or(word, String::as_str).to_owned();
                Kind::Fence { language, attributes, body }
            }
        };
        self.push(first, kind);
        self.at = first + length + 2;
    }

    /// Gives the lines from the current one to an empty one, joined, to `read`, which finds a block at their
    /// beginning and what is left of the line that it ends on.
    fn take<T>(&mut self, read: impl Fn(&str) -> Option<(T, &str)>) -> Option<T> {
        let lines = self.lines[self.at..].iter().map(|line| line.trim());
        let joined = lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join("\n");
        let (found, rest) = read(&joined)?;
        let (line, _) = rest.split_once('\n').unwrap_or((rest, ""));
        if !line.trim().is_empty() {
            return None;
        }
        self.at += joined[..joined.len() - rest.len()].matches('\n').count() + 1;
        Some(found)
    }

    fn equation(&mut self) {
        let first = self.at;
        let found = self.take(|text| {
            let body = text.strip_prefix("$$")?;
            let end = body.find("$$")?;
            let after = &body[end + 2..];
            let line = after.split_once('\n').map_or(after, |(line, _)| line);
            let (attributes, rest) = match line.trim_start() {
                "" => (Attributes::default(), after),
                _ => {
                    let after = after.trim_start();
                    let (attributes, length) = Attributes::parse(after)?;
                    (attributes, &after[length..])
                }
            };
            let tex_line = first + 1 + usize::from(body.starts_with('\n'));
            let tex = body[..end].trim().to_owned();
            Some((Kind::Equation { tex, attributes, tex_line }, rest))
        });
        self.push_or_unclosed(
            first,
            found,
            "a display equation ($$ … $$ with nothing but attributes behind it)",
        );
    }

    fn figure(&mut self) {
        let first = self.at;
        let found = self.take(|text| {
            let (caption, after) = matching(text.strip_prefix('!')?, '[', ']')?;
            let (path, after) = matching(after, '(', ')')?;
            let (attributes, length) = Attributes::parse(after)?;
            let (caption, path) = (caption.to_owned(), path.to_owned());
            Some((Kind::Figure { caption, path, attributes }, &after[length..]))
        });
        self.push_or_unclosed(
            first,
            found,
            "a figure (![caption](chapter/name.svg){#fig:label alt=\"…\"})",
        );
    }

    fn push_or_unclosed(&mut self, first: usize, found: Option<Kind>, what: &'static str) {
        if found.is_none() {
            self.at = first + 1;
        }
        self.push(first, found.unwrap_or(Kind::Unclosed(what)));
    }

    fn div(&mut self) {
        let rest = self.lines[self.at].trim().trim_start_matches(':').trim();
        let kind = match (rest, Attributes::whole(rest)) {
            ("", _) => Kind::Close,
            (_, Some(attributes)) => Kind::Open(attributes),
            (class, None) => {
                Kind::Open(Attributes { classes: vec![class.to_owned()], ..Attributes::default() })
            }
        };
        self.push(self.at, kind);
        self.at += 1;
    }

    fn comment(&mut self) {
        let first = self.at;
        let Some((last, after)) = self.end_of_comments() else {
            self.push(first, Kind::Unclosed("a comment"));
            self.at = self.lines.len();
            return;
        };
        if !after.is_empty() {
            let words = after.to_owned();
            self.push(last, Kind::AfterComment(words));
        } else if self.after_blank() {
            self.end_text();
        } else if let Some((_, text)) = &mut self.text {
            text.push_str(&format!("{COMMENT}\n").repeat(last + 1 - first));
        }
        self.at = last + 1;
    }

    /// The line on which the comments end that begin here one behind the other, and what stands behind them there.
    fn end_of_comments(&self) -> Option<(usize, &str)> {
        let (mut at, mut rest) = (self.at, self.lines[self.at]);
        loop {
            match rest.split_once("-->") {
                Some((_, after)) if after.trim_start().starts_with("<!--") => rest = after,
                Some((_, after)) => return Some((at, after.trim())),
                None => {
                    at += 1;
                    rest = self.lines.get(at)?;
                }
            }
        }
    }

    /// A line of an algorithm, and how many lines of the chapter it takes.
    fn step(&self) -> Option<(Kind, usize)> {
        let (number, text) = numbered(self.lines[self.at])?;
        let ends = |line: &&str| {
            let start = line.trim_start();
            start.is_empty() || start.starts_with(":::") || numbered(start).is_some()
        };
        let rest = &self.lines[self.at + 1..];
        let more = rest.iter().position(ends).unwrap_or(rest.len());
        let rest = rest[..more].iter().map(|line| line.trim());
        let text = [text.trim()].into_iter().chain(rest).collect::<Vec<_>>().join("\n");
        let at = text.rfind("{.step")?;
        let attributes = Attributes::whole(&text[at..])?;
        let text = text[..at].trim().to_owned();
        Some((Kind::Step { number, text, attributes }, more + 1))
    }

    fn choice(&mut self) {
        let first = self.at;
        let start = self.lines[first].trim_start();
        let right = start.starts_with("- [x]");
        let mut text = start[6..].to_owned();
        self.at += 1;
        while let Some(line) = self.lines.get(self.at).filter(|line| line.starts_with("  ")) {
            text.push('\n');
            text.push_str(line.trim());
            self.at += 1;
        }
        self.push(first, Kind::Choice { right, text });
    }
}

/// A line without so many bytes of the white space that it begins with, or fewer where a letter of it would be cut.
fn outdented(line: &str, indent: usize) -> &str {
    let own = line.len() - line.trim_start().len();
    let cut = (0..=own.min(indent)).rev().find(|at| line.is_char_boundary(*at));
    &line[cut.unwrap_or_default()..]
}

/// The number at the start of a line, and what follows it.
fn numbered(line: &str) -> Option<(usize, &str)> {
    let (number, text) = line.trim_start().split_once(". ")?;
    Some((number.parse().ok()?, text))
}

/// The text between a pair of brackets at the start of `text`, and what follows the closing one.
fn matching(text: &str, open: char, close: char) -> Option<(&str, &str)> {
    let body = text.strip_prefix(open)?;
    let mut depth = 1;
    for (at, c) in body.char_indices() {
        match c {
            c if c == open => depth += 1,
            c if c == close => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some((&body[..at], &body[at + close.len_utf8()..]));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_keep_their_lines_and_indentation() {
        let found = blocks(
            "# Title {#sec:a}\n\ntext\n\n1. step\n\n   $$\n   a = b\n   $$ {#eq:ab}\n\nmore\n",
        );
        let kinds: Vec<_> = found.iter().map(|block| (block.line, block.indent.as_str())).collect();
        assert_eq!(kinds, [(1, ""), (2, ""), (7, "   "), (10, "")]);
        let Kind::Equation { tex, attributes, tex_line: 8 } = &found[2].kind else {
            panic!("{:?}", found[2])
        };
        assert_eq!((tex.as_str(), attributes.id.as_str()), ("a = b", "eq:ab"));
    }

    #[test]
    fn a_fence_hides_what_looks_like_a_block() {
        let found = blocks("```text\n$$ x\n::: y\n```\n");
        assert_eq!(found.len(), 1);
    }

    #[test]
    fn a_caption_may_hold_brackets_and_span_lines() {
        let found =
            blocks("![Rays [of two\ncameras](x) meet](bearing/rays.svg){#fig:rays\nalt=\"a b\"}\n");
        let Kind::Figure { caption, path, attributes } = &found[0].kind else {
            panic!("{:?}", found[0])
        };
        assert_eq!(caption, "Rays [of two\ncameras](x) meet");
        assert_eq!((path.as_str(), attributes.value("alt")), ("bearing/rays.svg", "a b"));
    }

    #[test]
    fn a_line_of_an_algorithm_names_its_code_and_other_numbered_lines_stay_text() {
        let found = blocks(
            "1. one\n   two\n   {.step code=\"if x {\"}\n   2. inside {.step code=\"y\" of=\"A::b\"}\n\n1. text\n",
        );
        let Kind::Step { number: 1, text, attributes } = &found[0].kind else {
            panic!("{:?}", found[0])
        };
        assert_eq!((text.as_str(), attributes.value("code")), ("one\ntwo", "if x {"));
        assert_eq!((found[1].line, found[1].indent.as_str()), (4, "   "));
        assert!(matches!(&found[2].kind, Kind::Text(text) if text == "\n1. text\n"));
    }

    #[test]
    fn a_comment_moves_no_line_and_swallows_no_words() {
        let found = blocks("One.\n<!-- a\nb --> lost\nSee\n");
        let lines: Vec<_> = found.iter().map(|block| block.line).collect();
        assert_eq!(lines, [1, 3, 4]);
        assert_eq!(found[1].kind, Kind::AfterComment("lost".to_owned()));
        assert!(blocks("<!-- a --> <!-- b\n--> <!-- c -->\n").is_empty());
    }

    #[test]
    fn a_comment_inside_of_a_paragraph_does_not_end_it() {
        let found = blocks("One\n<!-- a\nb -->\nsentence.\n\n<!-- c -->\nAnother.\n");
        let [Block { kind: Kind::Text(one), .. }, Block { line: 7, .. }] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!(without_comments(one), "One\nsentence.\n\n");
        assert_eq!(one.lines().position(|line| line == "sentence."), Some(3));
    }

    #[test]
    fn attributes_may_hold_braces_and_are_told_where_they_never_end() {
        for (line, title) in [
            ("## A {#sec:a .depth establishes=\"A set {a} is.\"}", "A"),
            ("## A {b c} {#sec:a}", "A {b c}"),
        ] {
            let found = blocks(line);
            let Kind::Heading { title: found, attributes, .. } = &found[0].kind else {
                panic!("{found:?}")
            };
            assert_eq!((found.as_str(), attributes.id.as_str()), (title, "sec:a"));
        }
        for text in ["## A {#sec:a .b c=\"d}", "## A {b=\"c}", "## A {#a", "```{.rust a=\"b}\n```"]
        {
            let found = blocks(text);
            assert!(matches!(found[..], [Block { kind: Kind::Unclosed(_), .. }]), "{found:?}");
        }
        let found = blocks("## The set $\\{a\\}$ of {{value a.b}} and [x]{.prior}");
        assert!(matches!(found[0].kind, Kind::Heading { .. }), "{found:?}");
    }

    #[test]
    fn an_equation_that_never_ends_is_reported_where_it_begins() {
        let found = blocks("text\n$$ a\n\nmore\n");
        assert!(matches!(found[1], Block { line: 2, kind: Kind::Unclosed(_), .. }));
    }
}
