//! Writes a chapter for mdBook: its blocks as Markdown and HTML, with everything resolved.

mod algorithms;
mod depth;
mod divisions;
mod equations;
mod figures;
mod listings;
mod recordings;

use divisions::Division;
use maud::html;

use crate::attributes::Attributes;
use crate::blocks::{Block, Kind};
use crate::pages::{Page, anchor_of};
use crate::prose::{Found, Known, Prose, source};
use crate::reports::VERSION;
use crate::settings::{Layout, Settings};

/// Writes one page.
pub struct Emitter<'a, 'f> {
    /// The page.
    pub page: &'a Page,
    /// What is known of the whole book.
    pub known: &'a Known<'a>,
    /// The book's settings.
    pub settings: &'a Settings,
    /// Where things lie.
    pub layout: &'a Layout,
    /// What is learned on the way.
    pub found: &'a mut Found<'f>,
    open: Vec<Division>,
    /// The line of the heading that led into depth.
    depth: Option<usize>,
    out: String,
}

impl<'a, 'f> Emitter<'a, 'f> {
    /// An emitter for a page.
    pub fn new(
        page: &'a Page,
        known: &'a Known<'a>,
        settings: &'a Settings,
        layout: &'a Layout,
        found: &'a mut Found<'f>,
    ) -> Self {
        Emitter {
            page,
            known,
            settings,
            layout,
            found,
            open: Vec::new(),
            depth: None,
            out: String::new(),
        }
    }

    /// The page as mdBook reads it.
    pub fn emit(mut self) -> String {
        for block in &self.page.blocks {
            self.end_choices(&block.kind);
            self.end_depth(block.depth);
            self.block(block);
        }
        for division in std::mem::take(&mut self.open) {
            let problem = "a division (:::) is never closed";
            self.fault(
                division.line,
                &division.class,
                problem,
                "close it with ::: on a line of its own",
            );
        }
        self.end_depth(None);
        self.definitions();
        let report = self.known.reports.on(&self.page.slug, &self.page.file);
        let version = html! {
            p.version {
                "Version " (VERSION)
                @if let Some(report) = report { ". " a href=(report) { "Report an error on this page" } }
            }
        };
        self.lines("", &format!("\n{}", version.into_string()));
        self.out
    }

    fn block(&mut self, block: &Block) {
        let line = block.line;
        if !self.fits_algorithm(block) {
            return;
        }
        if let Some((word, known)) = block.kind.unknown() {
            let mend = format!("mend the name; known here are {known}");
            self.fault(line, word, "nothing reads this attribute", mend);
        }
        match &block.kind {
            Kind::Text(text) if self.in_algorithm().is_some() => self.parts(line, text),
            Kind::Text(text) => {
                let text = self.resolve(line, text);
                self.out.push_str(&text);
            }
            Kind::Heading { level, title, attributes } => {
                self.heading(block, *level, title, attributes)
            }
            Kind::Equation { tex, attributes, tex_line } => {
                self.equation(block, tex, *tex_line, attributes)
            }
            Kind::Figure { caption, path, attributes } => {
                self.figure(block, caption, path, attributes)
            }
            Kind::Fence { language, attributes, body } => {
                self.fence(block, language, attributes, body)
            }
            Kind::Open(attributes) => self.open(block, attributes),
            Kind::Close => self.close(line),
            Kind::Choice { right, text } => self.choice(line, *right, text),
            Kind::Step { number, text, attributes } => self.step(block, *number, text, attributes),
            Kind::IndentedCode(code) => {
                self.fault(
                    line,
                    code.trim(),
                    "four spaces make this a block of code",
                    "indent less, or include code as a listing",
                );
            }
            Kind::AfterComment(words) => {
                let problem = "what stands behind a comment on its last line is not shown";
                self.fault(line, words, problem, "begin a new line behind -->");
            }
            Kind::Unclosed(what) => {
                self.fault(line, "", format!("{what} begins here and never ends"), "close it")
            }
        }
    }

    fn fault(
        &mut self,
        line: usize,
        label: &str,
        problem: impl Into<String>,
        mend: impl Into<String>,
    ) {
        self.found.faults.add((&self.page.file, line), label, problem, mend);
    }

    fn resolve(&mut self, line: usize, text: &str) -> String {
        self.prose(line, true).resolve(text, self.known, self.found)
    }

    fn plain(&mut self, line: usize, text: &str) -> String {
        self.prose(line, false).resolve(text, self.known, self.found)
    }

    fn prose(&self, line: usize, html: bool) -> Prose<'a> {
        Prose { page: self.page, line, html, deep: self.depth.is_some() || self.on_sheet() }
    }

    /// Writes lines with the indentation of their block, so that what stands in a list stays there.
    fn lines(&mut self, indent: &str, text: &str) {
        for line in text.lines() {
            if !line.is_empty() {
                self.out.push_str(indent);
                self.out.push_str(line);
            }
            self.out.push('\n');
        }
    }

    /// Stands for what cannot be shown, so that links to it lead somewhere and are not counted as faults of their own.
    fn missing(&mut self, id: &str) {
        self.out.push_str(&format!("\n<p id=\"{id}\">[{id}]</p>\n\n"));
    }

    fn source(&mut self, file: &str, line: usize) -> String {
        source(self.page, file, line, self.found)
    }

    /// Whether a label has the kind that its block asks for.
    fn labelled(&mut self, line: usize, attributes: &Attributes, kind: &str, what: &str) -> bool {
        let fits = attributes.id.strip_prefix(kind).is_some_and(|name| !name.is_empty());
        if !fits {
            self.fault(
                line,
                &attributes.id,
                format!("{what} needs a label of its kind"),
                format!("write {{#{kind}name}} behind it"),
            );
        }
        fits
    }

    fn heading(&mut self, block: &Block, level: usize, title: &str, attributes: &Attributes) {
        let shown = self.resolve(block.line, title);
        if level == 1 && self.page.number.is_some() && title != self.page.name {
            let problem = format!("the table of contents calls this page “{}”", self.page.name);
            self.fault(
                block.line,
                title,
                problem,
                "give both the same words, in src/SUMMARY.md or here",
            );
        }
        let number = match level {
            1 => self.page.number.as_deref().unwrap_or_default(),
            _ => &block.number,
        };
        let number = if number.is_empty() { String::new() } else { format!("{number} ") };
        let id = match attributes.id.is_empty() {
            true if block.number.is_empty() => String::new(),
            _ => format!(" {{#{}}}", anchor_of(title, attributes)),
        };
        self.out.push_str(&format!("{} {number}{shown}{id}\n", "#".repeat(level)));
        if !attributes.value("subtitle").is_empty() {
            let subtitle = self.resolve(block.line, attributes.value("subtitle"));
            self.out.push_str(&format!("\n<p class=\"subtitle\">{subtitle}</p>\n"));
        }
        if attributes.has("depth") {
            self.begin_depth(block, attributes);
        }
    }
}
