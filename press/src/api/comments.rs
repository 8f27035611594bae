//! Rewrites the descriptions of items: labels and citations become links, equations are shown, sources are named.
//!
//! What comes out is a copy of each file for rustdoc, line by line, and each line knows which one it comes from.

use std::collections::BTreeMap;
use std::path::Path;

use maud::html;
use regex::Captures;

use super::items::{File, Library};
use crate::bibliography::Bibliography;
use crate::fault::Faults;
use crate::formulas::Formula;
use crate::inline::{Mark, NAMED_LABEL, tokens};
use crate::pages::{Labels, Page, slashed};
use crate::prose::{REFERENCES, name_of};

/// How an address begins that is meant from the root of the book; which way that is, only a finished page knows.
pub const BOOK: &str = "book:/";

/// A line of the copy.
#[derive(Debug, PartialEq)]
pub struct Line {
    /// The line of the file that it comes from, counted from 1.
    pub origin: usize,
    /// What it says.
    pub pieces: Vec<Piece>,
}

/// A piece of a line.
#[derive(Debug, PartialEq)]
pub enum Piece {
    /// Text for rustdoc.
    Text(String),
    /// A formula, to be rendered.
    Math {
        /// Its TeX.
        tex: String,
        /// Whether it is displayed or runs with the text.
        display: bool,
    },
}

/// What the book has to say to the descriptions.
pub struct Book<'a> {
    /// The library.
    pub library: &'a Library,
    /// The chapters.
    pub pages: &'a [Page],
    /// Every label and where it stands.
    pub labels: &'a Labels,
    /// What can be cited.
    pub bibliography: &'a Bibliography,
    /// The TeX of the numbered equations by label, with their numbers filled in.
    pub equations: BTreeMap<&'a str, &'a str>,
}

/// What is found in the descriptions.
#[derive(Default)]
pub struct Noted {
    /// Labels and works that do not exist, formulas that never end.
    pub faults: Faults,
    /// The formulas, to be tried by KaTeX.
    pub formulas: Vec<Formula>,
}

/// The copy of a file.
pub fn copy(file: &File, book: &Book<'_>, noted: &mut Noted) -> Vec<Line> {
    let sources: Vec<&str> = file.text.lines().collect();
    let mut lines = Vec::new();
    if file.module.is_empty() {
        // The book has pages of its own for sources.
        let pieces = vec![Piece::Text("#![doc(html_no_source)]".to_owned())];
        lines.push(Line { origin: 1, pieces });
    }
    let mut at = 0;
    while at < sources.len() {
        let Some((head, _)) = described(sources[at]) else {
            let pieces = vec![Piece::Text(sources[at].to_owned())];
            lines.push(Line { origin: at + 1, pieces });
            at += 1;
            continue;
        };
        let text: Vec<&str> = sources[at..]
            .iter()
            .map_while(|line| described(line).filter(|(next, _)| *next == head))
            .map(|(_, text)| text)
            .collect();
        let mut writer = Writer { file, book, noted, head, lines: Vec::new() };
        writer.description(&text, at + 1, head.ends_with("//!"));
        if head.ends_with("///") {
            writer.source(at + 1, at + text.len());
        }
        lines.append(&mut writer.lines);
        at += text.len();
    }
    lines
}

/// The indentation and mark of a line of a description, and what it says.
fn described(line: &str) -> Option<(&str, &str)> {
    let start = line.trim_start();
    if start.starts_with("////") || !(start.starts_with("///") || start.starts_with("//!")) {
        return None;
    }
    let (head, text) = line.split_at(line.len() - start.len() + 3);
    Some((head, text.strip_prefix(' ').unwrap_or(text)))
}

struct Writer<'a, 'b> {
    file: &'a File,
    book: &'a Book<'b>,
    noted: &'a mut Noted,
    head: &'a str,
    lines: Vec<Line>,
}

impl Writer<'_, '_> {
    /// A description that begins on a line; `of_module` when it stands inside of what it describes.
    fn description(&mut self, text: &[&str], first: usize, of_module: bool) {
        let mut at = 0;
        let mut paragraphs = 0;
        while at < text.len() {
            let origin = first + at;
            if text[at].trim_start().starts_with("```") {
                let rest = &text[at + 1..];
                let end = rest.iter().position(|line| line.trim_start().starts_with("```"));
                let length = end.map_or(rest.len(), |end| end + 1) + 1;
                for (more, line) in text[at..at + length].iter().enumerate() {
                    self.line(origin + more, line);
                }
                at += length;
                continue;
            }
            let ends = |line: &&str| line.trim().is_empty() || line.trim_start().starts_with("```");
            let length = text[at..].iter().position(ends).unwrap_or(text.len() - at);
            if length == 0 {
                self.line(origin, "");
                at += 1;
                continue;
            }
            self.paragraph(&text[at..at + length].join("\n"), origin);
            at += length;
            paragraphs += 1;
            if paragraphs == 1 && of_module {
                self.chapter(first + at - 1);
            }
        }
    }

    fn line(&mut self, origin: usize, text: &str) {
        self.pieces(origin, vec![Piece::Text(text.to_owned())]);
    }

    fn pieces(&mut self, origin: usize, mut pieces: Vec<Piece>) {
        let empty =
            pieces.iter().all(|piece| matches!(piece, Piece::Text(text) if text.is_empty()));
        let head = if empty { self.head.to_owned() } else { format!("{} ", self.head) };
        pieces.insert(0, Piece::Text(head));
        self.lines.push(Line { origin, pieces });
    }

    /// A block of HTML between empty lines.
    fn block(&mut self, origin: usize, pieces: Vec<Piece>) {
        self.line(origin, "");
        self.pieces(origin, pieces);
        self.line(origin, "");
    }

    fn paragraph(&mut self, text: &str, origin: usize) {
        let display = text.trim().strip_prefix("$$").and_then(|rest| rest.strip_suffix("$$"));
        if let Some(tex) = display.filter(|tex| !tex.contains("$$") && !tex.trim().is_empty()) {
            let math = self.math(tex.trim(), true, origin);
            return self.block(origin, framed(math));
        }
        let mut line = Line { origin, pieces: Vec::new() };
        let tokens = tokens(text);
        for (which, token) in tokens.iter().enumerate() {
            let end = tokens.get(which + 1).map_or(text.len(), |next| next.at);
            let raw = &text[token.at..end];
            let here = origin + token.line;
            match &token.mark {
                Mark::Math(tex) => {
                    let math = self.math(tex, false, here);
                    line.pieces.push(math);
                    continue;
                }
                Mark::Citation { keys, narrative } => {
                    line.pieces.push(Piece::Text(self.citation(keys, *narrative, here)));
                    continue;
                }
                Mark::UnclosedMath | Mark::MisplacedDisplay => self.noted.faults.add(
                    (&self.file.name, here),
                    "$",
                    "a formula in a description begins here and does not end as it should",
                    r"close it with $, put $$ … $$ into a paragraph of its own, or write \$ for the sign itself",
                ),
                _ => {}
            }
            let linked = matches!(token.mark, Mark::Plain(_));
            for (more, part) in raw.split('\n').enumerate() {
                if more > 0 {
                    let next = Line { origin: here + more, pieces: Vec::new() };
                    let done = std::mem::replace(&mut line, next);
                    self.pieces(done.origin, done.pieces);
                }
                let part = if linked { self.linked(part, here + more) } else { part.to_owned() };
                line.pieces.push(Piece::Text(part));
            }
        }
        let last = line.origin;
        self.pieces(last, line.pieces);
        for tex in self.implemented(text) {
            let pieces = framed(Piece::Math { tex, display: true });
            self.block(last, pieces);
        }
    }

    fn math(&mut self, tex: &str, display: bool, line: usize) -> Piece {
        self.noted.formulas.push(Formula {
            file: self.file.name.clone(),
            line,
            label: String::new(),
            tex: tex.to_owned(),
            display,
        });
        Piece::Math { tex: tex.to_owned(), display }
    }

    /// Text with its labels as links into the book.
    fn linked(&mut self, text: &str, line: usize) -> String {
        let (file, labels) = (&self.file.name, self.book.labels);
        let faults = &mut self.noted.faults;
        let link = |found: &Captures<'_>| {
            let label = &found[1];
            let Some(target) = labels.get(label) else {
                let mend = match labels.like(label) {
                    Some(like) => format!("did you mean {{{like}}}?"),
                    None => format!("write {{#{label}}} behind what it should lead to"),
                };
                let problem = "nothing in the book has this label";
                faults.add((file, line), format!("{{{label}}}"), problem, mend);
                return format!("`{label}`");
            };
            let page = slashed(&target.path.with_extension("html"));
            format!("[{}]({BOOK}{page}#{label})", name_of(label, target, false))
        };
        NAMED_LABEL.replace_all(text, link).into_owned()
    }

    /// Works as links to the bibliography.
    fn citation(&mut self, keys: &[&str], narrative: bool, line: usize) -> String {
        let page = slashed(&Path::new(REFERENCES).with_extension("html"));
        let place = (self.file.name.as_str(), line);
        let faults = &mut self.noted.faults;
        let works = keys.iter().map(|cited| {
            match self.book.bibliography.cited(place, cited, narrative, faults) {
                (key, Some(name)) => format!("[{name}]({BOOK}{page}#ref:{key})"),
                (key, None) => format!("`{key}`"),
            }
        });
        let works = works.collect::<Vec<_>>().join("; ");
        if narrative { works } else { format!("({works})") }
    }

    /// The TeX of the equations that a paragraph says the item implements.
    fn implemented(&self, text: &str) -> Vec<String> {
        let Some((_, after)) = text.split_once("Implements") else { return Vec::new() };
        let labels = NAMED_LABEL.captures_iter(after).map(|found| found.extract::<1>().1[0]);
        labels
            .filter_map(|label| self.book.equations.get(label))
            .map(|&tex| tex.to_owned())
            .collect()
    }

    /// The chapter that the module belongs to, and its source.
    fn chapter(&mut self, origin: usize) {
        let slug = self.file.module.first();
        let chapter = self.book.pages.iter().find(|page| Some(&page.slug) == slug);
        let name = &self.file.name;
        let text = html! {
            p.book-source {
                @if let Some(page) = chapter {
                    "Chapter" @if let Some(number) = &page.number { " " (number) } ": "
                    a href={ (BOOK) (slashed(&page.path.with_extension("html"))) } { (page.title()) } ". "
                }
                "Source: " a href={ (BOOK) (source_page(name, 1)) } { (name) }
            }
        };
        self.block(origin, vec![Piece::Text(text.into_string())]);
    }

    /// Where the item stands whose description begins and ends on these lines, when it has a place of its own in the
    /// pages.
    fn source(&mut self, first: usize, last: usize) {
        let name = &self.file.name;
        let Some(item) = self.book.library.described(name, first) else { return };
        let way = html! { a href={ (BOOK) (source_page(name, item.line)) } { (name) ", line " (item.line) } };
        self.line(last, "");
        self.line(last, &html! { p.book-source { "Source: " (way) } }.into_string());
    }
}

/// The page of a line of a source file, below `src`.
fn source_page(file: &str, line: usize) -> String {
    format!("generated/source/{file}.html#L{line}")
}

fn framed(math: Piece) -> Vec<Piece> {
    let (open, close) = ("<div class=\"book-equation\">", "</div>");
    vec![Piece::Text(open.to_owned()), math, Piece::Text(close.to_owned())]
}
