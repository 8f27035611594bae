//! Resolves the marks inside a paragraph: references, citations, values, coloured terms.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::LazyLock;

use maud::{Markup, PreEscaped, Render, html};
use regex::{Captures, Regex};

use crate::accepted::Accepted;
use crate::api::items::{Item, Library};
use crate::attributes::Attributes;
use crate::bibliography::Bibliography;
use crate::blocks::without_comments;
use crate::exhibits::Exhibits;
use crate::fault::Faults;
use crate::formulas::Formula;
use crate::index::{Definition, Terms};
use crate::inline::{LABEL_KINDS, Mark, Token, tokens};
use crate::lint::{Lint, UNITS};
use crate::pages::{Labels, Page, Target, slashed};
use crate::recordings::Recording;
use crate::reports::Reports;
use crate::symbols::{Symbol, Symbols};
use crate::theorems::Theorems;
use crate::ways::{Ways, planned};

static UNIT: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(&format!(r"^\s(?:{UNITS})(?:$|[^\w])")).expect("a valid pattern"));

/// The page of the bibliography, relative to `src`.
pub const REFERENCES: &str = "references.md";

/// The classes that a coloured term may have.
pub const TERMS: [&str; 3] = ["measured", "estimated", "prior"];

/// What can be said of a span.
const SPAN_KEYS: [&str; 6] = ["frame", "means", "name", "shape", "term", "unit"];

/// What the press knows before it writes a page.
pub struct Known<'a> {
    /// Every label and where it stands.
    pub labels: &'a Labels,
    /// The theorems and their conditions.
    pub theorems: &'a Theorems,
    /// Chapters and sections, and how long they take.
    pub ways: &'a Ways,
    /// What the program computed.
    pub exhibits: &'a Exhibits,
    /// What can be cited.
    pub bibliography: &'a Bibliography,
    /// The items that have a page.
    pub library: &'a Library,
    /// The accepted TeX of the equations, by the chapter that owns their checks.
    pub accepted: &'a BTreeMap<String, Accepted>,
    /// The names of the pictures to take hold of, and how many bytes each has that was compiled.
    pub widgets: &'a BTreeMap<String, Option<usize>>,
    /// The scenes that have a picture.
    pub recordings: &'a BTreeMap<String, Recording>,
    /// Where errors are reported.
    pub reports: &'a Reports,
}

/// What the press learns while it writes the pages.
pub struct Found<'a> {
    /// The promises broken so far.
    pub faults: Faults,
    /// Every formula, to be tried by KaTeX.
    pub formulas: Vec<Formula>,
    /// The numbers in use, and the pages that use them.
    pub values: BTreeMap<String, BTreeSet<PathBuf>>,
    /// The figures in use, as `chapter/name`.
    pub figures: BTreeSet<String>,
    /// The scenes that are shown.
    pub recordings: BTreeSet<String>,
    /// The citations of each work: page, title of the page, anchor.
    pub citations: BTreeMap<String, Vec<(PathBuf, String)>>,
    /// The terms that the book defines.
    pub terms: Terms,
    /// What its letters mean.
    pub symbols: Symbols,
    /// The statements that have an address of their own: page and name.
    pub sayings: BTreeSet<(PathBuf, String)>,
    /// The items of the library that listings and algorithms show: page, anchor and name of each.
    pub printed: BTreeMap<String, Vec<(PathBuf, String, String)>>,
    /// The algorithms whose lines lead to the library.
    pub algorithms: Vec<Told>,
    /// The source files that pages link to.
    pub sources: BTreeSet<String>,
    /// Files for mdBook to copy, by path below `src/generated`.
    pub generated: BTreeMap<PathBuf, Vec<u8>>,
    /// Typed numbers and the permissions for them.
    pub lint: Lint<'a>,
}

impl<'a> Found<'a> {
    /// Nothing yet but the faults that were there before, and the permissions for typed numbers.
    pub fn new(faults: Faults, lint: Lint<'a>) -> Self {
        Self {
            faults,
            formulas: Vec::new(),
            values: BTreeMap::new(),
            figures: BTreeSet::new(),
            recordings: BTreeSet::new(),
            citations: BTreeMap::new(),
            terms: Terms::default(),
            symbols: Symbols::default(),
            sayings: BTreeSet::new(),
            printed: BTreeMap::new(),
            algorithms: Vec::new(),
            sources: BTreeSet::new(),
            generated: BTreeMap::new(),
            lint,
        }
    }
}

/// An algorithm that a page tells.
pub struct Told {
    /// The page.
    pub page: PathBuf,
    /// Its label.
    pub id: String,
    /// Its number.
    pub number: String,
    /// The item of the library that does it.
    pub item: String,
    /// How many lines it has.
    pub lines: usize,
}

/// A stretch of prose on a page.
#[derive(Clone, Copy)]
pub struct Prose<'a> {
    /// The page.
    pub page: &'a Page,
    /// The line it begins on.
    pub line: usize,
    /// Whether marks become HTML, or plain text as in an alternative text.
    pub html: bool,
    /// Whether it is in depth, off the main road.
    pub deep: bool,
}

impl Prose<'_> {
    /// The text with its marks resolved.
    pub fn resolve(&self, text: &str, known: &Known<'_>, found: &mut Found<'_>) -> String {
        let mut out = String::with_capacity(text.len());
        let tokens = tokens(text);
        for (at, token) in tokens.iter().enumerate() {
            let place = (self.page.file.as_str(), self.line + token.line);
            let one = One { prose: self, place, known };
            let mut written = String::new();
            one.mark(&token.mark, &mut written, found);
            let after_value = at > 0 && matches!(tokens[at - 1].mark, Mark::Value(_));
            match UNIT.find(&written).filter(|_| after_value) {
                // A number and its unit stay on one line.
                Some(_) => out.push_str(&written.replacen(char::is_whitespace, "\u{a0}", 1)),
                None => out.push_str(&written),
            }
        }
        without_comments(&out)
    }

    /// Where a label leads to from here. It may lead into depth: what asks for it is a pointer, and not a step of the
    /// main road.
    pub fn lead(&self, label: &str, known: &Known<'_>, found: &mut Found<'_>) -> Option<Lead> {
        let one = One { prose: self, place: (&self.page.file, self.line), known };
        let target = one.target(label, true, found)?;
        let plain = Prose { html: false, deep: true, ..*self };
        let title = plain.resolve(&target.title, known, found);
        Some(Lead { way: one.way_to(label, target), name: name_of(label, target, false), title })
    }
}

/// A place of the book, as a link to it needs it.
pub struct Lead {
    /// The way to it.
    pub way: String,
    /// How it is called, such as `Section 3.2`.
    pub name: String,
    /// Its title; empty for what has none.
    pub title: String,
}

impl Lead {
    /// Name and title.
    pub fn in_full(&self) -> String {
        match self.title.as_str() {
            title if title.is_empty() || title == self.name => self.name.clone(),
            title => format!("{}, {title}", self.name),
        }
    }
}

/// One mark and where it stands.
struct One<'a> {
    prose: &'a Prose<'a>,
    place: (&'a str, usize),
    known: &'a Known<'a>,
}

impl One<'_> {
    fn mark(&self, mark: &Mark<'_>, out: &mut String, found: &mut Found<'_>) {
        if let Mark::Span { attributes, .. } = mark {
            self.unread(attributes, found);
        }
        match mark {
            Mark::Plain(text) => {
                found.lint.prose(self.place, &self.prose.page.owner, text, &mut found.faults);
                out.push_str(text);
            }
            Mark::Code(code) => out.push_str(code),
            Mark::Math(tex) => out.push_str(&self.math(tex, found)),
            Mark::Value(name) => out.push_str(&self.value(name, found)),
            Mark::Reference { label, bare } => {
                let name = self.reference(label, *bare, self.prose.deep, found);
                out.push_str(&name);
            }
            Mark::Citation { keys, narrative } => {
                out.push_str(&self.citation(keys, *narrative, found));
            }
            Mark::Item { text, path } => out.push_str(&self.item(text, path, found)),
            Mark::Span { text, attributes } if attributes.has("defined") => {
                out.push_str(&self.defined(text, attributes.value("term"), found));
            }
            Mark::Span { text, attributes } if attributes.has("symbol") => {
                out.push_str(&self.symbol(text, attributes, found));
            }
            Mark::Span { text, attributes } if attributes.has("saying") => {
                out.push_str(&self.saying(text, &attributes.id, found));
            }
            Mark::Span { text, attributes } => {
                let class = attributes.classes.first().map_or("", String::as_str);
                out.push_str(&self.span(text, class, found));
            }
            Mark::Directive(word @ ("ledger" | "bibliography" | "index" | "mine")) => {
                out.push_str(&format!("{{{{{word}}}}}"));
            }
            Mark::Directive(words) => match words.split_once(char::is_whitespace) {
                Some(("again", label)) => out.push_str(&self.again(label.trim(), found)),
                Some(("way", words)) => out.push_str(&self.stop(words, found)),
                Some(("time", words)) => out.push_str(&self.time(words, found)),
                _ => self.misused(mark, found),
            },
            Mark::UnclosedMath
            | Mark::UnclosedBraces
            | Mark::NoAttributes
            | Mark::MisplacedDisplay
            | Mark::Nested => self.misused(mark, found),
        }
    }

    /// Faults for what a span says of itself and nothing reads.
    fn unread(&self, attributes: &Attributes, found: &mut Found<'_>) {
        if let Some(key) = attributes.key_beyond(&SPAN_KEYS) {
            let mend = format!("mend the name; known are {}", SPAN_KEYS.join(", "));
            found.faults.add(self.place, key, "no span has such an attribute", mend);
        }
        if let Some(class) = attributes.classes.get(1) {
            let mend = "put one span into the other: [[…]{.condition name=\"…\"}]{.measured}";
            found.faults.add(
                self.place,
                class,
                "a span has one class, and this is its second",
                mend,
            );
        }
        if !attributes.id.is_empty() && !attributes.has("saying") {
            let mend = "remove it, or make the span a saying";
            found.faults.add(
                self.place,
                &attributes.id,
                "only a saying has a name to link to",
                mend,
            );
        }
    }

    fn misused(&self, mark: &Mark<'_>, found: &mut Found<'_>) {
        let (label, problem, mend) = match mark {
            Mark::Directive(word) => (
                *word,
                "the press knows no such directive",
                "it knows {{value chapter.name}}, {{again eq:label}}, {{way chapter#section}}, {{time chapter chapter#section}}, {{mine}}, {{ledger}}, {{index}} and {{bibliography}}; code is included by a listing",
            ),
            Mark::UnclosedMath => (
                "$",
                "a formula begins here and never ends",
                r"close it with $, or write \$ for the sign itself",
            ),
            Mark::UnclosedBraces => (
                "{{",
                "two braces begin here and are never closed",
                "close them with }}, or write code for the signs themselves",
            ),
            Mark::NoAttributes => (
                "[",
                "braces behind these brackets are no attributes",
                "write [words]{.class key=\"value\"}, closed and with a dot before the class",
            ),
            Mark::Nested => (
                "[",
                "too many brackets stand one in the other",
                "close a bracket before the next is opened",
            ),
            _ => (
                "$$",
                "a display equation in the middle of a paragraph",
                "put $$ on a line of its own",
            ),
        };
        found.faults.add(self.place, label, problem, mend);
    }

    fn math(&self, tex: &str, found: &mut Found<'_>) -> String {
        found.lint.tex(self.place, &self.prose.page.owner, tex, &mut found.faults);
        let tex = without_comments(tex);
        let filled = fill(&tex, self.prose.page, self.place, self.known, found);
        if self.prose.html {
            found.formulas.push(Formula {
                file: self.place.0.to_owned(),
                line: self.place.1,
                label: String::new(),
                tex: filled.clone(),
                display: false,
            });
        }
        format!("${filled}$")
    }

    /// A term where it is defined. The index has it under `term`, or as it stands here.
    fn defined(&self, text: &str, term: &str, found: &mut Found<'_>) -> String {
        let inside = Prose { line: self.place.1, ..*self.prose }.resolve(text, self.known, found);
        let term = if term.is_empty() {
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        } else {
            term.to_owned()
        };
        let place = (self.place.0.to_owned(), self.place.1);
        let definition =
            Definition { path: self.prose.page.path.clone(), place, deep: self.prose.deep };
        let id = Terms::anchor(&term);
        found.terms.define(&term, definition, &mut found.faults);
        match self.prose.html {
            true => format!("<dfn id=\"{id}\">{inside}</dfn>"),
            false => inside,
        }
    }

    /// A statement of its own, in bold, with an address that others can link to.
    fn saying(&self, text: &str, id: &str, found: &mut Found<'_>) -> String {
        if id.is_empty() {
            let mend = "give it one, as in [“…”]{.saying #depth-sigma}";
            found.faults.add(self.place, text, "a saying has no name to link to", mend);
        } else if self.prose.html
            && !found.sayings.insert((self.prose.page.path.clone(), id.to_owned()))
        {
            let problem = "an earlier saying of this page has this name";
            found.faults.add(self.place, format!("saying:{id}"), problem, "take another name");
        }
        let inside = Prose { line: self.place.1, ..*self.prose }.resolve(text, self.known, found);
        match self.prose.html {
            true => format!(
                "<strong id=\"saying:{id}\"><a class=\"saying\" href=\"#saying:{id}\">{inside}</a></strong>"
            ),
            false => format!("**{inside}**"),
        }
    }

    /// A letter where it is explained.
    fn symbol(&self, text: &str, attributes: &Attributes, found: &mut Found<'_>) -> String {
        let inside = Prose { line: self.place.1, ..*self.prose }.resolve(text, self.known, found);
        let tex = text.trim().trim_matches('$');
        match Symbol::marked(tex, attributes, self.place, self.prose.deep) {
            Ok((letter, symbol)) => {
                let id = Symbols::anchor(&letter);
                found.symbols.define(self.prose.page, letter, symbol, &mut found.faults);
                match self.prose.html {
                    true => format!("<span id=\"{id}\">{inside}</span>"),
                    false => inside,
                }
            }
            Err(problem) => {
                let mend = "write [$…$]{.symbol means=\"…\" shape=\"…\" unit=\"…\" frame=\"…\"}";
                found.faults.add(self.place, text, problem, mend);
                inside
            }
        }
    }

    /// A numbered equation once more, with the way to where it is derived.
    fn again(&self, label: &str, found: &mut Found<'_>) -> String {
        let Some(target) = self.target(label, self.prose.deep, found) else {
            return format!("[{label}]");
        };
        let tex = fill(&target.tex, self.prose.page, self.place, self.known, found);
        if tex.is_empty() {
            let mend = "name an equation";
            found.faults.add(self.place, label, "this is no equation to show again", mend);
        }
        let (way, number) = (self.way_to(label, target), &target.number);
        format!("\n{}", equation_html("", &tex, &equation_number(&way, number)))
    }

    /// A link to a chapter or a section on a way through the book, with the time that it takes. Behind
    /// `all` what is in depth counts too.
    fn stop(&self, words: &str, found: &mut Found<'_>) -> String {
        let (name, depth) = with_depth(words);
        static WAY: LazyLock<Regex> =
            LazyLock::new(|| Regex::new(r"\{\{\s*way\s").expect("a valid pattern"));
        let Some(stop) = self.known.ways.get(name) else { return self.no_stop(name, found) };
        if WAY.is_match(&stop.title) {
            let (problem, mend) = ("the title that a way leads to names a way", "write it below");
            found.faults.add(self.place, name, problem, mend);
            return format!("[{name}]");
        }
        let title = Prose { line: self.place.1, deep: true, ..*self.prose }.resolve(
            &stop.title,
            self.known,
            found,
        );
        let time = planned(stop.seconds[depth]).replace(' ', "\u{a0}");
        let text = PreEscaped(format!("{} {title}", stop.number));
        let way = link(self.prose.page, &stop.path, &stop.anchor, text);
        let whole = if stop.seconds[depth] > stop.seconds[0] { " with depth" } else { "" };
        format!("{} ({time}{whole})", way.into_string())
    }

    /// The time that several chapters and sections take together on the main road; `all` as above.
    fn time(&self, words: &str, found: &mut Found<'_>) -> String {
        let (names, depth) = with_depth(words);
        let mut seconds = 0.0;
        for name in names.split_whitespace() {
            match self.known.ways.get(name) {
                Some(stop) => seconds += stop.seconds[depth],
                None => drop(self.no_stop(name, found)),
            }
        }
        planned(seconds).replace(' ', "\u{a0}")
    }

    fn no_stop(&self, name: &str, found: &mut Found<'_>) -> String {
        let mend = match self.known.ways.like(name) {
            Some(like) => format!("did you mean {like}?"),
            None => "write the chapter's slug, and behind # the anchor of a section".to_owned(),
        };
        found.faults.add(self.place, name, "the book has no such chapter or section", mend);
        format!("[{name}]")
    }

    fn value(&self, name: &str, found: &mut Found<'_>) -> String {
        let Some((value, text)) = number(name, self.prose.page, self.place, self.known, found)
        else {
            return format!("[{name}]");
        };
        let shown = text.replace('-', "−");
        match self.prose.html {
            true => html! { data.value value=(value) title=(name) { (shown) } }.into_string(),
            false => shown,
        }
    }

    /// A link to what a label stands for.
    fn reference(&self, label: &str, bare: bool, leads_on: bool, found: &mut Found<'_>) -> String {
        let Some(target) = self.target(label, leads_on, found) else {
            return format!("[{label}]");
        };
        let name = name_of(label, target, bare);
        match self.prose.html {
            true => format!("<a class=\"xref\" href=\"{}\">{name}</a>", self.way_to(label, target)),
            false => name,
        }
    }

    /// What a label stands for. From the main road, only a pointer `leads_on` into depth.
    fn target(&self, label: &str, leads_on: bool, found: &mut Found<'_>) -> Option<&Target> {
        let Some(target) = self.known.labels.get(label) else {
            let mend = match self.known.labels.like(label) {
                Some(like) => format!("did you mean @{like}?"),
                None => format!("write {{#{label}}} behind what it should lead to"),
            };
            let problem = "nothing in the book has this label";
            found.faults.add(self.place, format!("@{label}"), problem, mend);
            return None;
        };
        if target.deep && !leads_on {
            let problem = "the main road needs something that is in depth";
            let mend =
                format!("say it here, or point to it for further reading: [@{label}]{{.further}}");
            found.faults.add(self.place, format!("@{label}"), problem, mend);
        }
        Some(target)
    }

    fn way_to(&self, label: &str, target: &Target) -> String {
        let page = self.prose.page;
        let way = if target.path == page.path { String::new() } else { page.way_to(&target.path) };
        format!("{way}#{label}")
    }

    fn item(&self, text: &str, path: &str, found: &mut Found<'_>) -> String {
        let inside = Prose { line: self.place.1, ..*self.prose }.resolve(text, self.known, found);
        let Some(item) = self.known.library.item(path) else {
            let mend = match self.known.library.like(path) {
                Some(like) => format!("did you mean api:{like}?"),
                None => format!("name a public item of {}", crate::api::items::SOURCES),
            };
            let problem = "the library has no such public item";
            found.faults.add(self.place, format!("api:{path}"), problem, mend);
            return inside;
        };
        match self.prose.html {
            true => {
                let text = PreEscaped(inside);
                item_link(self.prose.page, self.known.library, item, text).into_string()
            }
            false => inside,
        }
    }

    fn citation(&self, keys: &[&str], narrative: bool, found: &mut Found<'_>) -> String {
        let links: Vec<String> = keys.iter().map(|key| self.work(key, narrative, found)).collect();
        match narrative {
            true => links.concat(),
            false => format!("({})", links.join("; ")),
        }
    }

    fn work(&self, cited: &str, narrative: bool, found: &mut Found<'_>) -> String {
        let works = self.known.bibliography;
        let (key, name) = works.cited(self.place, cited, narrative, &mut found.faults);
        let Some(name) = name else { return format!("[{key}]") };
        if !self.prose.html {
            return name;
        }
        let citations = found.citations.entry(key.to_owned()).or_default();
        let anchor = format!("cite:{key}-{}", citations.len() + 1);
        citations.push((self.prose.page.path.clone(), anchor.clone()));
        let way = self.prose.page.way_to(REFERENCES.as_ref());
        html! { a.citation id=(anchor) href={ (way) "#ref:" (key) } { (name) } }.into_string()
    }

    /// A pointer from the main road into depth: one reference and nothing else.
    fn further(&self, text: &str, found: &mut Found<'_>) -> String {
        match &tokens(text)[..] {
            [Token { mark: Mark::Reference { label, bare }, .. }] => {
                self.reference(label, *bare, true, found)
            }
            _ => {
                let mend = "write [@sec:name]{.further}";
                found.faults.add(self.place, text, "a pointer into depth is one reference", mend);
                text.to_owned()
            }
        }
    }

    fn span(&self, text: &str, class: &str, found: &mut Found<'_>) -> String {
        if class == "further" {
            return self.further(text, found);
        }
        let inside = Prose { line: self.place.1, ..*self.prose }.resolve(text, self.known, found);
        match class {
            // The theorems know their conditions; in print they are what the counterexamples speak of.
            "condition" => match self.prose.html {
                true => format!("<span class=\"condition\">{inside}</span>"),
                false => inside,
            },
            "screen" => match self.prose.html {
                true => format!("<span class=\"screen\">{inside}</span>"),
                false => String::new(),
            },
            class if TERMS.contains(&class) => match self.prose.html {
                true => format!("<span class=\"term {class}\">{inside}</span>"),
                false => inside,
            },
            _ => {
                found.faults.add(
                    self.place,
                    class,
                    "a span has no class that the book knows",
                    format!(
                        "coloured terms are {}, a term that is explained is defined, a letter is a symbol, what a theorem assumes is a condition, a statement with an address of its own is a saying, what only a screen can do is screen, and a pointer into depth is further",
                        TERMS.join(", ")
                    ),
                );
                inside
            }
        }
    }
}

/// How a reference calls what it leads to: `Equation (1.2)`, or the number alone.
pub fn name_of(label: &str, target: &Target, bare: bool) -> String {
    let number = match label.starts_with("eq:") {
        true => format!("({})", target.number),
        false => target.number.clone(),
    };
    let word = match LABEL_KINDS.iter().find(|kind| label.starts_with(**kind)) {
        _ if target.number.is_empty() => return target.title.clone(),
        Some(&"alg:") => "Algorithm",
        Some(&"eq:") => "Equation",
        Some(&"fig:") => "Figure",
        Some(&"lst:") => "Listing",
        Some(&"thm:") => "Theorem",
        Some(&"sec:") if target.chapter && target.path.starts_with("exercises") => "Exercise",
        Some(&"sec:") if target.chapter => "Chapter",
        _ => "Section",
    };
    match bare {
        true => number,
        false => format!("{word}\u{a0}{number}"),
    }
}

/// The names behind a directive, and which of the two times counts: behind `all`, that with depth.
fn with_depth(words: &str) -> (&str, usize) {
    match words.trim().strip_prefix("all ") {
        Some(names) => (names.trim(), 1),
        None => (words.trim(), 0),
    }
}

/// An equation as a page shows it, with what stands beside it.
pub fn equation_html(attributes: &str, tex: &str, beside: &str) -> String {
    format!(
        "<div class=\"equation\"{attributes}>\n<div class=\"equation-body\">\n\n$${tex}$$\n\n</div>\n{beside}</div>\n"
    )
}

/// The number of an equation, which leads to it.
pub fn equation_number(way: &str, number: &str) -> String {
    format!(
        "<a class=\"equation-number\" href=\"{way}\" aria-label=\"Equation {number}\">({number})</a>\n"
    )
}

/// TeX with its computed numbers filled in.
pub fn fill(
    tex: &str,
    page: &Page,
    place: (&str, usize),
    known: &Known<'_>,
    found: &mut Found<'_>,
) -> String {
    static VALUE: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"\{\{\s*value\s+([^\s}]+)\s*\}\}").expect("a valid pattern"));
    let text = |value: &Captures<'_>| {
        number(&value[1], page, place, known, found).map_or("?", |(_, text)| text).to_owned()
    };
    VALUE.replace_all(tex, text).into_owned()
}

/// A number and its text; a fault when there is none.
fn number<'a>(
    name: &str,
    page: &Page,
    place: (&str, usize),
    known: &Known<'a>,
    found: &mut Found<'_>,
) -> Option<(f64, &'a str)> {
    match known.exhibits.number(name) {
        None => {
            let (problem, mend) = known.exhibits.why_no_number(name, &page.owner);
            found.faults.add(place, name, problem, mend);
        }
        Some((None, _)) => found.faults.add(
            place,
            name,
            "the computed number is not finite",
            "find out why the program computes no number",
        ),
        Some((Some(value), text)) => {
            found.values.entry(name.to_owned()).or_default().insert(page.path.clone());
            return Some((value, text));
        }
    }
    None
}

/// A link to a page of the book, from another one.
pub fn link(from: &Page, to: &std::path::Path, anchor: &str, text: impl Render) -> Markup {
    let way = if from.path == *to { String::new() } else { from.way_to(to) };
    html! { a href={ (way) "#" (anchor) } { (text) } }
}

/// A link to the page of an item of the library.
pub fn item_link(from: &Page, library: &Library, item: &Item, text: impl Render) -> Markup {
    let way = from.way_to(item.page.as_ref());
    html! { a.api href=(way) title={ (library.name) "::" (item.path) } { (text) } }
}

/// Several things with commas between.
pub fn listed<T: Render>(things: impl Iterator<Item = T>) -> Markup {
    html! { @for (at, thing) in things.enumerate() { @if at > 0 { ", " } (thing) } }
}

/// A table that scrolls by itself where the page is narrow; a row is its cells.
pub fn table(class: Option<&str>, columns: &[impl Render], rows: &[Markup]) -> Markup {
    html! {
        div.table-wrapper { table class=[class] {
            thead { tr { @for name in columns { th { (name) } } } }
            tbody { @for row in rows { tr { (row) } "\n" } }
        } }
    }
}

/// The way from a page to a line of a source file, which is thereby added to the source pages.
pub fn source(page: &Page, file: &str, line: usize, found: &mut Found<'_>) -> String {
    let file = slashed(file.as_ref());
    let path = PathBuf::from(format!("generated/source/{file}.html"));
    found.sources.insert(file);
    format!("{}#L{line}", page.way_to(&path))
}
