//! Algorithms: what goes in and comes out, what it costs and refuses, and lines that lead to those of the library.

use std::collections::BTreeMap;

use maud::html;

use super::Emitter;
use crate::api::items::{Code, Library, SOURCES};
use crate::attributes::Attributes;
use crate::blocks::{Block, COMMENT, Kind};
use crate::prose::Told;

/// What an algorithm says before its lines, in this order.
const PARTS: [&str; 5] = ["Given", "Result", "Cost", "Refused", "Derived"];

/// How many other functions a fault names.
const OTHERS: usize = 3;

/// An algorithm as far as it has been written.
#[derive(Default)]
pub(super) struct Algorithm {
    /// The path of the item that does it.
    item: String,
    /// Its number.
    number: String,
    /// The parts that it has.
    parts: Vec<String>,
    /// The indentation of each list of lines that is open.
    levels: Vec<usize>,
    /// How many lines there are.
    lines: usize,
    /// The line of the library that was named last, by the path of the code that has it.
    last: BTreeMap<String, usize>,
}

impl Algorithm {
    /// One of which nothing has been written, of the item that does it.
    pub(super) fn of(item: &str, number: &str) -> Algorithm {
        let (item, number) = (item.to_owned(), number.to_owned());
        Algorithm { item, number, ..Algorithm::default() }
    }

    /// What has to stand before a line with this indentation.
    fn begin_line(&mut self, indent: usize) -> String {
        let mut before = String::new();
        if self.lines == 0 {
            before.push_str("</dl>\n");
        }
        self.lines += 1;
        while self.levels.last().is_some_and(|level| *level > indent) {
            self.levels.pop();
            before.push_str("</li>\n</ol>\n");
        }
        if self.levels.last() == Some(&indent) {
            before.push_str("</li>\n");
        } else {
            self.levels.push(indent);
            before.push_str("<ol class=\"steps\" role=\"list\">\n");
        }
        before
    }

    /// What closes all lists that are open.
    fn end(&self) -> String {
        match self.lines {
            0 => "</dl>\n".to_owned(),
            _ => "</li>\n</ol>\n".repeat(self.levels.len()),
        }
    }
}

impl Emitter<'_, '_> {
    /// Begins an algorithm; gives what it is called.
    pub(super) fn algorithm(&mut self, block: &Block, attributes: &Attributes) -> String {
        let line = block.line;
        self.labelled(line, attributes, "alg:", "an algorithm");
        let title = self.resolve(line, attributes.value("title"));
        let path = attributes.value("item");
        let name = path.rsplit("::").take(2).collect::<Vec<_>>();
        let name = name.into_iter().rev().collect::<Vec<_>>().join("::");
        let item = self.resolve(line, &format!("[`{name}`](api:{path})"));
        let id = &attributes.id;
        if let Some(item) = self.known.library.item(path) {
            self.shows(item, id, format!("Algorithm\u{a0}{}", block.number));
        }
        format!(
            "<div class=\"algorithm\" id=\"{id}\">\n<div class=\"algorithm-title\">\n\n**Algorithm {}.** {title} <span class=\"source\">API:\u{a0}{item}</span>\n\n</div>\n<dl>\n",
            block.number
        )
    }

    /// The algorithm whose parts and lines come next, if there is one.
    pub(super) fn in_algorithm(&mut self) -> Option<&mut Algorithm> {
        self.open.last_mut()?.algorithm.as_mut()
    }

    /// Whether a block is of the kinds that an algorithm is made of, if it stands in one.
    pub(super) fn fits_algorithm(&mut self, block: &Block) -> bool {
        let fits = matches!(block.kind, Kind::Text(_) | Kind::Step { .. } | Kind::Close);
        let fits = fits || self.in_algorithm().is_none();
        if !fits {
            let problem = "an algorithm has parts and numbered lines, and nothing else";
            self.fault(block.line, "", problem, "put this before or behind it");
        }
        fits
    }

    /// The parts of an algorithm: a name on a line of its own, and below it `: what it says`.
    pub(super) fn parts(&mut self, first: usize, text: &str) {
        let lines: Vec<&str> = text.lines().collect();
        let mut at = 0;
        for paragraph in lines.split(|line| line.trim().is_empty() && *line != COMMENT) {
            let line = first + at;
            at += paragraph.len() + 1;
            let [name, below @ ..] = paragraph else { continue };
            let comments = below.iter().take_while(|line| **line == COMMENT).count();
            let said = below[comments..].join("\n");
            match said.strip_prefix(": ") {
                Some(said) => self.part(line, name, (line + comments + 1, said)),
                None => {
                    let problem =
                        "this is no part of an algorithm, and no line that names its code";
                    let mend = "write a part as its name with `: what it says` below, and a line as `1. what is done {.step code=\"…\"}`";
                    self.fault(line, name, problem, mend);
                }
            }
        }
    }

    fn part(&mut self, line: usize, name: &str, said: (usize, &str)) {
        let said = self.resolve(said.0, said.1);
        let Some(algorithm) = self.in_algorithm() else { return };
        let due = PARTS.get(algorithm.parts.len()).copied().unwrap_or_default();
        algorithm.parts.push(name.to_owned());
        if name != due || algorithm.lines > 0 {
            let problem = "this part does not belong here";
            let mend = format!("an algorithm has these, before its lines: {}", PARTS.join(", "));
            self.fault(line, name, problem, mend);
            return;
        }
        self.out.push_str(&format!("<div><dt>{name}</dt><dd>\n\n{said}\n\n</dd></div>\n"));
    }

    /// A line of an algorithm, whose number leads to the line of the library that does it.
    pub(super) fn step(
        &mut self,
        block: &Block,
        number: usize,
        text: &str,
        attributes: &Attributes,
    ) {
        let (line, label) = (block.line, format!("{number}."));
        let text = self.resolve(line, text);
        let Some(algorithm) = self.in_algorithm() else {
            let problem = "a line that names its code stands outside of an algorithm";
            return self.fault(line, &label, problem, "put it into ::: {.algorithm #alg:name …}");
        };
        let before = algorithm.begin_line(block.indent.len());
        let due = algorithm.lines;
        let of = match attributes.value("of") {
            "" => algorithm.item.clone(),
            other => other.to_owned(),
        };
        if number != due {
            let problem = format!("this is line {due} of its algorithm");
            self.fault(line, &label, problem, "count the lines through, also those of loops");
        }
        let number = match self.code_of(line, &label, &of, attributes.value("code")) {
            None => html! { span.step-number { (number) } },
            Some((file, at)) => {
                let href = self.source(&file, at);
                let place = format!("{file}, line {at}");
                let short = format!("{}:{at}", file.trim_start_matches(SOURCES).trim_matches('/'));
                html! {
                    a.step-number href=(href) title=(place) data-place=(short)
                        aria-label={ "Line " (number) ": " (place) } { (number) }
                }
            }
        };
        let number = number.into_string();
        self.out.push_str(&format!("{before}<li value=\"{due}\">{number}\n\n{text}\n\n"));
    }

    /// The file and line of the library that have a text, when it stands once in the code of a path, and not before
    /// the line that was named last there.
    fn code_of(
        &mut self,
        line: usize,
        label: &str,
        of: &str,
        text: &str,
    ) -> Option<(String, usize)> {
        let library = self.known.library;
        let found = named(library, of)
            .and_then(|code| line_with(library, &code, text).map(|at| (code, at)));
        let (Code { path, file, .. }, at) = match found {
            Ok(found) => found,
            Err(Wrong { problem, mend }) => {
                self.fault(line, label, problem, mend);
                return None;
            }
        };
        let before = self.in_algorithm().and_then(|known| known.last.insert(path, at));
        if let Some(before) = before.filter(|before| *before > at) {
            let problem = format!(
                "the library does this before what stands above: {file}, line {at} and not after {before}"
            );
            self.fault(line, label, problem, "bring the lines into the order of the code");
        }
        Some((file.to_owned(), at))
    }

    /// Ends an algorithm that is complete.
    pub(super) fn end_algorithm(&mut self, line: usize, id: &str, algorithm: &Algorithm) -> String {
        let missing = PARTS.iter().find(|part| !algorithm.parts.iter().any(|name| name == *part));
        if let Some(part) = missing {
            let problem = format!("the algorithm does not say what is “{part}”");
            let mend = format!("write `{part}` on a line of its own, and below it `: …`");
            self.fault(line, id, problem, mend);
        }
        if algorithm.lines == 0 {
            let problem = "the algorithm has no lines";
            self.fault(line, id, problem, "write them as `1. what is done {.step code=\"…\"}`");
        }
        let Algorithm { item, number, lines, .. } = algorithm;
        self.found.algorithms.push(Told {
            page: self.page.path.clone(),
            id: id.to_owned(),
            number: number.clone(),
            item: item.clone(),
            lines: *lines,
        });
        format!("{}</div>", algorithm.end())
    }
}

/// Why a line leads nowhere, and what to do about it.
struct Wrong {
    problem: String,
    mend: String,
}

/// The one piece of code that a path means.
fn named<'a>(library: &'a Library, path: &str) -> Result<Code<'a>, Wrong> {
    let mut found = library.code(path);
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(Wrong {
            problem: format!("the library has nothing that is called {path}"),
            mend: "write of=\"Type::function\", or item=\"…\" at the algorithm".to_owned(),
        }),
        count => Err(Wrong {
            problem: format!("the library has {count} of the name {path}"),
            mend: format!("write more of its path: {}", paths(&found)),
        }),
    }
}

/// The one line of some code that has a text.
fn line_with(library: &Library, code: &Code<'_>, text: &str) -> Result<usize, Wrong> {
    let Code { path, file, first, last, .. } = code;
    let place = format!("{path} ({file}, lines {first} to {last})");
    let lines = if text.is_empty() { Vec::new() } else { code.lines_with(text) };
    match &lines[..] {
        [line] => Ok(*line),
        [] => {
            let others = library.functions_with(text);
            let mend = match text.is_empty() || others.is_empty() {
                true => "write code=\"…\" as the line is now".to_owned(),
                false => format!("it stands in {}: say so by of=\"…\"", paths(&others)),
            };
            Err(Wrong { problem: format!("`{text}` stands nowhere in {place}"), mend })
        }
        many => {
            let many = many.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
            let problem = format!("`{text}` stands more than once in {place}: {many}");
            Err(Wrong { problem, mend: "write more of the line that is meant".to_owned() })
        }
    }
}

/// The paths of some pieces of code, as many as help.
fn paths(found: &[Code<'_>]) -> String {
    found.iter().take(OTHERS).map(|code| code.path.as_str()).collect::<Vec<_>>().join(", ")
}
