//! Writes a chapter for mdBook: its blocks as Markdown and HTML, with everything resolved.

use std::path::{Component, Path, PathBuf};
use std::sync::LazyLock;

use regex::Regex;

use crate::accepted::{Accepted, normal};
use crate::attributes::Attributes;
use crate::blocks::{Block, Kind};
use crate::exhibits::{Check, Drawing, check_function};
use crate::files;
use crate::formulas::Formula;
use crate::listing;
use crate::pages::Page;
use crate::prose::{Found, Known, Prose, TERMS, escape, fill, source};
use crate::settings::{Layout, Settings};

/// The rows of a figure's data that the page shows; the CSV file has all.
const ROWS_SHOWN: usize = 40;

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
    /// The accepted TeX of this page's equations.
    pub accepted: &'a Accepted,
    /// What is learned on the way.
    pub found: &'a mut Found<'f>,
    open: Vec<Division>,
    out: String,
}

/// An open `:::` and what was seen in it.
struct Division {
    line: usize,
    class: String,
    id: String,
    right_choices: usize,
    in_choices: bool,
    reveals: usize,
}

impl<'a, 'f> Emitter<'a, 'f> {
    /// An emitter for a page.
    pub fn new(
        page: &'a Page,
        known: &'a Known<'a>,
        settings: &'a Settings,
        layout: &'a Layout,
        accepted: &'a Accepted,
        found: &'a mut Found<'f>,
    ) -> Self {
        Emitter {
            page,
            known,
            settings,
            layout,
            accepted,
            found,
            open: Vec::new(),
            out: String::new(),
        }
    }

    /// The page as mdBook reads it.
    pub fn emit(mut self) -> String {
        for block in &self.page.blocks {
            self.end_choices(&block.kind);
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
        self.definitions();
        self.out
    }

    fn block(&mut self, block: &Block) {
        let line = block.line;
        match &block.kind {
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
            Kind::IndentedCode(code) => {
                self.fault(
                    line,
                    code.trim(),
                    "four spaces make this a block of code",
                    "indent less, or include code as a listing",
                );
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
        Prose { page: self.page, line, html: true }.resolve(text, self.known, self.found)
    }

    fn plain(&mut self, line: usize, text: &str) -> String {
        Prose { page: self.page, line, html: false }.resolve(text, self.known, self.found)
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
        let number = match level {
            1 => self.page.number.as_deref().unwrap_or_default(),
            _ => &block.number,
        };
        let number = if number.is_empty() { String::new() } else { format!("{number} ") };
        let id = match attributes.id.is_empty() {
            true if block.number.is_empty() => String::new(),
            true => format!(" {{#{}}}", anchor(title)),
            false => format!(" {{#{}}}", attributes.id),
        };
        self.out.push_str(&format!("{} {number}{shown}{id}\n", "#".repeat(level)));
    }

    fn equation(&mut self, block: &Block, tex: &str, tex_line: usize, attributes: &Attributes) {
        let place = (self.page.file.as_str(), tex_line);
        self.found.lint.tex(place, &self.page.slug, tex, &mut self.found.faults);
        let filled = fill(tex, self.page, place, self.known, self.found);
        self.found.formulas.push(Formula {
            file: self.page.file.clone(),
            line: tex_line,
            label: attributes.id.clone(),
            tex: filled.clone(),
            display: true,
        });
        let numbered = !attributes.id.is_empty()
            && self.labelled(block.line, attributes, "eq:", "a numbered equation");
        if !numbered {
            return self.lines(&block.indent, &format!("<div class=\"equation\">\n<div class=\"equation-body\">\n\n$${filled}$$\n\n</div>\n</div>\n"));
        }
        if block.number.is_empty() {
            self.fault(
                block.line,
                &attributes.id,
                "a numbered equation stands in a chapter that has no number",
                "remove its label, or number the chapter in SUMMARY.md",
            );
        }
        let (id, number) = (&attributes.id, &block.number);
        let mark = match attributes.has("definition") {
            true => self.definition(block.line, id),
            false => self.check(block.line, id, tex),
        };
        let html = format!(
            "<div class=\"equation\" id=\"{id}\">\n<div class=\"equation-body\">\n\n$${filled}$$\n\n</div>\n\
             <a class=\"equation-number\" href=\"#{id}\" aria-label=\"Equation {number}\">({number})</a>\n{mark}\n</div>\n"
        );
        self.lines(&block.indent, &html);
    }

    fn definition(&mut self, line: usize, id: &str) -> String {
        if self.known.exhibits.check(&self.page.slug, &id[3..]).is_some() {
            self.fault(
                line,
                id,
                "a definition has nothing to check, and this one has a check",
                "drop .definition, or the check",
            );
        }
        "<p class=\"definition-mark margin\">definition</p>".to_owned()
    }

    fn check(&mut self, line: usize, id: &str, tex: &str) -> String {
        let (slug, label) = (self.page.slug.clone(), &id[3..]);
        let Some(check) = self.known.exhibits.check(&slug, label).cloned() else {
            self.fault(line, id, "no check computes this equation", format!("write `fn {}` in exhibits/src/{slug}.rs and register it, or mark the equation {{#{id} .definition}}", label.replace('-', "_")));
            return String::new();
        };
        match self.accepted.equations.get(label) {
            None => self.fault(
                line,
                id,
                "this equation was never held against its check",
                "read both, then run `cargo book accept`",
            ),
            Some(known) if *known != normal(tex) => {
                self.fault(
                    line,
                    id,
                    format!(
                        "the TeX is not the one that was held against its check, which was: {known}"
                    ),
                    "see that the check still says the same, then run `cargo book accept`",
                );
            }
            Some(_) => {}
        }
        let (file, line) = check_function(&self.layout.root, &slug, label)
            .unwrap_or((check.file.clone(), check.line));
        let href = self.source(&file, line);
        note(&check, &href)
    }

    fn figure(&mut self, block: &Block, caption: &str, path: &str, attributes: &Attributes) {
        self.labelled(block.line, attributes, "fig:", "a figure");
        let id = &attributes.id;
        if attributes.value("alt").trim().is_empty() {
            self.fault(
                block.line,
                id,
                "the figure has no alternative text",
                "say in alt=\"…\" what a reader who cannot see it should know",
            );
        }
        let name = path.trim_end_matches(".svg");
        let drawing =
            name.split_once('/').and_then(|(slug, name)| self.known.exhibits.drawing(slug, name));
        let Some((drawing, folder)) = drawing else {
            let slug = name.split_once('/').map_or(self.page.slug.as_str(), |(slug, _)| slug);
            self.missing(id);
            return self.fault(
                block.line,
                path,
                "no program draws this figure",
                format!("register it in exhibits/src/{slug}.rs; the path is chapter/name.svg"),
            );
        };
        self.found.figures.insert(name.to_owned());
        let alt = escape(&self.plain(block.line, attributes.value("alt")));
        let caption = self.resolve(block.line, caption);
        let read = |end: &str| files::read(&folder.join(format!("{}.{end}", drawing.name)));
        let (svg, csv) = match (read("svg"), read("csv")) {
            (Ok(svg), Ok(csv)) => (svg, csv),
            (Err(error), _) | (_, Err(error)) => {
                return self.fault(
                    block.line,
                    id,
                    format!("{error:#}"),
                    "delete target/press and build again",
                );
            }
        };
        let data = self.data(block, name, drawing, csv);
        let svg: String = svg
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty() && !line.starts_with("<?xml"))
            .collect::<Vec<_>>()
            .join(" ");
        let html = format!(
            "<figure class=\"exhibit\" id=\"{id}\">\n<div class=\"plot\" role=\"img\" aria-label=\"{alt}\">{svg}</div>\n<figcaption>\n\n**Figure {}.** {}\n\n</figcaption>\n{data}\n</figure>\n",
            block.number,
            caption.replace('\n', " "),
        );
        self.lines(&block.indent, &html);
    }

    /// The data of a figure as a fold with a table, its CSV file and the program that drew it.
    fn data(&mut self, block: &Block, name: &str, drawing: &Drawing, csv: String) -> String {
        let path = PathBuf::from(format!("{name}.csv"));
        let file = self.page.way_to(&Path::new("generated").join(&path));
        self.found.generated.insert(path, csv.into_bytes());
        let program = self.source(&drawing.file, drawing.line);
        let row = |cell: &str, cells: &[String]| {
            let cells: String =
                cells.iter().map(|text| format!("<{cell}>{}</{cell}>", escape(text))).collect();
            format!("<tr>{cells}</tr>")
        };
        let rows: String =
            drawing.rows.iter().take(ROWS_SHOWN).map(|cells| row("td", cells)).collect();
        let more = match drawing.rows.len().saturating_sub(ROWS_SHOWN) {
            0 => String::new(),
            more => format!("{more} more rows in the "),
        };
        format!(
            "<details class=\"data\"><summary>Data of Figure {}</summary><div class=\"table-wrapper\"><table><thead>{}</thead><tbody>{rows}</tbody></table></div>\
             <p>{more}<a href=\"{file}\" download>CSV file</a> · <a href=\"{program}\">program</a></p></details>",
            block.number,
            row("th", &drawing.columns),
        )
    }

    fn fence(&mut self, block: &Block, language: &str, attributes: &Attributes, body: &[String]) {
        let include = match body {
            [line] => {
                line.trim().strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}"))
            }
            _ => None,
        };
        match (include, language) {
            (Some(target), _) => self.listing(block, language, attributes, target.trim()),
            (None, "") => self.fault(
                block.line,
                "",
                "a code block does not say its language",
                "write it behind the back-ticks; `text` for what has none",
            ),
            (None, "rust") => {
                self.fault(block.line, "", "Rust is typed into the chapter", "put the code into a crate, where it is compiled, and include it by its anchor: {{#include ../code/src/x.rs:anchor}}");
            }
            (None, _) => {
                let longest = body
                    .iter()
                    .map(|line| line.len() - line.trim_start_matches('`').len())
                    .max()
                    .unwrap_or(0);
                let mark = "`".repeat(longest.max(2) + 1);
                let text = format!("{mark}{language}\n{}\n{mark}\n", body.join("\n"));
                self.lines(&block.indent, &text);
            }
        }
    }

    fn listing(&mut self, block: &Block, language: &str, attributes: &Attributes, target: &str) {
        if !self.labelled(block.line, attributes, "lst:", "a listing") {
            return;
        }
        let id = &attributes.id;
        let (path, name) = target.rsplit_once(':').unwrap_or((target, ""));
        let Some(file) = self.included(path) else {
            self.missing(id);
            return self.fault(
                block.line,
                id,
                format!("{path} is not a file of the book"),
                "mend the path, which begins at the chapter's folder",
            );
        };
        let cut = files::read(&self.layout.root.join(&file))
            .ok()
            .and_then(|text| listing::cut(&text, name));
        let Some(cut) = cut else {
            self.missing(id);
            return self.fault(
                block.line,
                id,
                format!("{file} has no anchor `{name}`"),
                format!("enclose the code in // ANCHOR: {name} and // ANCHOR_END: {name}"),
            );
        };
        let longest = self.settings.longest_listing;
        if cut.code.len() > longest {
            self.fault(
                block.line,
                id,
                format!(
                    "the listing has {} lines, and {longest} is what a reader can hold",
                    cut.code.len()
                ),
                "cut it in two, or print only the part the text speaks of",
            );
        }
        self.labels_in(block.line, id, &cut.code);
        let caption = attributes.value("caption").to_owned();
        if caption.is_empty() {
            self.fault(
                block.line,
                id,
                "the listing has no caption",
                "say in caption=\"…\" what it does",
            );
        }
        let caption = self.resolve(block.line, &caption);
        let href = self.source(&file, cut.first);
        let html = format!(
            "<figure class=\"listing\" id=\"{id}\">\n<figcaption>\n\n**Listing {}.** {caption} <a class=\"source\" href=\"{href}\">{file}, lines {}–{}</a>\n\n</figcaption>\n\n```{language},ignore\n{}\n```\n\n</figure>\n",
            block.number,
            cut.first,
            cut.last,
            cut.code.join("\n"),
        );
        self.lines(&block.indent, &html);
    }

    /// Looks up the labels that printed code names, as in `Implements {eq:projection}`.
    fn labels_in(&mut self, line: usize, id: &str, code: &[String]) {
        static LABEL: LazyLock<Regex> = LazyLock::new(|| {
            Regex::new(r"\{((?:eq|fig|lst|sec|thm):[\w-]+)\}").expect("a valid pattern")
        });
        for found in code.iter().flat_map(|text| LABEL.captures_iter(text)) {
            if self.known.labels.get(&found[1]).is_none() {
                self.fault(
                    line,
                    id,
                    format!(
                        "the listing names {}, and nothing in the book has this label",
                        &found[1]
                    ),
                    "mend the comment in the source",
                );
            }
        }
    }

    /// The file of an include, relative to the root of the book; none when it lies outside or is absent.
    fn included(&self, path: &str) -> Option<String> {
        let from = Path::new("src").join(self.page.path.parent()?);
        let mut parts: Vec<String> = Vec::new();
        for part in from.join(path).components() {
            match part {
                Component::ParentDir => drop(parts.pop()?),
                Component::Normal(part) => parts.push(part.to_str()?.to_owned()),
                _ => return None,
            }
        }
        let file = parts.join("/");
        self.layout.root.join(&file).is_file().then_some(file)
    }

    fn open(&mut self, block: &Block, attributes: &Attributes) {
        let class = attributes.classes.first().cloned().unwrap_or_default();
        let id = &attributes.id;
        let html = match class.as_str() {
            "opening" => self.opening(block.line, attributes),
            "predict" => {
                self.labelled(block.line, attributes, "predict:", "a prediction");
                let key = id.trim_start_matches("predict:");
                format!(
                    "<div class=\"predict\" role=\"group\" aria-label=\"Prediction\" id=\"{id}\" data-key=\"{}/{key}\">\n<p class=\"predict-label\">Predict before you read on</p>\n",
                    self.page.slug
                )
            }
            "reveal" => {
                self.open.last_mut().into_iter().for_each(|division| division.reveals += 1);
                "<details class=\"reveal\"><summary>Reveal the answer</summary>\n".to_owned()
            }
            "theorem" => {
                self.labelled(block.line, attributes, "thm:", "a theorem");
                let title = self.resolve(block.line, attributes.value("title"));
                format!(
                    "<div class=\"theorem\" id=\"{id}\">\n<p class=\"theorem-title\">Theorem {} ({title}).</p>\n",
                    block.number
                )
            }
            "proof" => "<div class=\"proof\">\n<p class=\"proof-title\">Proof.</p>\n".to_owned(),
            "note" => "<div class=\"margin note\" role=\"note\">\n".to_owned(),
            other => {
                let known = "opening, predict, reveal, theorem, proof, note";
                self.fault(
                    block.line,
                    other,
                    "a division has no class that the book knows",
                    format!("it knows {known}"),
                );
                String::new()
            }
        };
        self.out.push('\n');
        self.out.push_str(&html);
        self.out.push('\n');
        self.open.push(Division {
            line: block.line,
            class,
            id: id.clone(),
            right_choices: 0,
            in_choices: false,
            reveals: 0,
        });
    }

    fn opening(&mut self, line: usize, attributes: &Attributes) -> String {
        let mut terms = String::new();
        for key in ["difficulty", "needs"] {
            let value = self.resolve(line, attributes.value(key));
            if value.is_empty() {
                self.fault(
                    line,
                    "opening",
                    format!("the opening does not say {key}=\"…\""),
                    "a reader wants to know before reading",
                );
            }
            let (name, value) = match key {
                "difficulty" => ("Difficulty", format!("{value} of 3")),
                _ => ("Needs", value),
            };
            terms.push_str(&format!("<dt>{name}</dt><dd>{value}</dd>"));
            if key == "difficulty" {
                terms.push_str(&format!(
                    "<dt>Reading time</dt><dd>{} minutes</dd>",
                    minutes(self.page)
                ));
            }
        }
        format!("<div class=\"opening\">\n<dl>{terms}</dl>\n")
    }

    fn close(&mut self, line: usize) {
        let Some(division) = self.open.pop() else {
            return self.fault(
                line,
                ":::",
                "this closes a division that was never opened",
                "remove it",
            );
        };
        let end = match division.class.as_str() {
            "reveal" => "</details>".to_owned(),
            "opening" => format!("</div>\n{}", legend(self.page)),
            "predict" => {
                if division.right_choices != 1 || division.reveals != 1 {
                    self.fault(division.line, &division.id, format!("a prediction has one right choice and one reveal, and this one has {} and {}", division.right_choices, division.reveals), "write the choices as `- [ ] …`, the right one as `- [x] …`, and the answer in ::: reveal");
                }
                "</div>".to_owned()
            }
            "theorem" | "proof" | "note" => "</div>".to_owned(),
            _ => String::new(),
        };
        self.out.push_str(&format!("\n{end}\n\n"));
    }

    fn choice(&mut self, line: usize, right: bool, text: &str) {
        let text = self.resolve(line, text);
        let Some(division) = self.open.last_mut().filter(|division| division.class == "predict")
        else {
            return self.fault(
                line,
                "- [ ]",
                "a choice stands outside of a prediction",
                "put it into ::: {.predict #predict:name}",
            );
        };
        if !std::mem::replace(&mut division.in_choices, true) {
            self.out.push_str("\n<ol class=\"choices\">\n");
        }
        division.right_choices += usize::from(right);
        let mark = if right { " data-right" } else { "" };
        self.out.push_str(&format!("<li{mark}>\n\n{text}\n\n</li>\n"));
    }

    /// Ends a list of choices when something else than white space follows.
    fn end_choices(&mut self, next: &Kind) {
        let goes_on = matches!(next, Kind::Choice { .. })
            || matches!(next, Kind::Text(text) if text.trim().is_empty());
        if let Some(division) = self.open.last_mut()
            && division.in_choices
            && !goes_on
        {
            division.in_choices = false;
            self.out.push_str("</ol>\n\n");
        }
    }

    /// Definitions are what a chapter asks its reader to take; too many, and little is left that a check can reach.
    fn definitions(&mut self) {
        let numbered: Vec<&Attributes> = self
            .page
            .blocks
            .iter()
            .filter_map(|block| match &block.kind {
                Kind::Equation { attributes, .. } if !attributes.id.is_empty() => Some(attributes),
                _ => None,
            })
            .collect();
        let definitions = numbered.iter().filter(|attributes| attributes.has("definition")).count();
        if definitions as f64 > self.settings.definition_share * numbered.len() as f64 {
            let problem = format!(
                "{definitions} of {} numbered equations are definitions, which no check can reach",
                numbered.len()
            );
            let mend = format!(
                "at most {} of them may be; give checks to some, or remove their labels",
                self.settings.definition_share
            );
            self.fault(0, "", problem, mend);
        }
    }
}

/// The quiet note beside a checked equation.
fn note(check: &Check, href: &str) -> String {
    let worst = check.worst.map_or("not a number".to_owned(), |worst| format!("{worst:.0e}"));
    format!(
        "<details class=\"check margin\"><summary>checked: <span class=\"quantity\">{worst}</span> over {states} states</summary><p>Largest error {worst}{unit}, tolerance {:.0e}{unit}, over {states} states, against {}. The check rejects {} wrong formulas: {}. <a href=\"{href}\">Its code</a></p></details>",
        check.tolerance,
        escape(&check.against),
        check.mutants.len(),
        escape(&check.mutants.join(", ")),
        states = check.states,
        unit = unit(check),
    )
}

/// The unit of an error as it follows the number; nothing for a relative one.
fn unit(check: &Check) -> String {
    match check.unit.as_str() {
        "" | "relative" => String::new(),
        unit => format!("\u{a0}{}", escape(unit)),
    }
}

/// The colours a page uses, explained.
fn legend(page: &Page) -> String {
    let meaning = [
        "what a sensor reported",
        "what is computed from it, and may be wrong",
        "what was believed before",
    ];
    let uses = |term: &str| {
        let (macro_, class) = (format!("\\{term}{{"), format!("{{.{term}}}"));
        page.blocks.iter().any(|block| match &block.kind {
            Kind::Text(text) => text.contains(&macro_) || text.contains(&class),
            Kind::Equation { tex, .. } => tex.contains(&macro_),
            _ => false,
        })
    };
    let terms: Vec<String> = TERMS
        .iter()
        .zip(meaning)
        .filter(|(term, _)| uses(term))
        .map(|(term, meaning)| format!("<span class=\"term {term}\">{term}</span>: {meaning}"))
        .collect();
    match terms.is_empty() {
        true => String::new(),
        false => format!("<p class=\"legend\">{}</p>", terms.join("; ")),
    }
}

/// Reading time: prose at 200 words a minute, half a minute for an equation or a figure, one for a listing.
fn minutes(page: &Page) -> usize {
    let seconds = |kind: &Kind| match kind {
        Kind::Text(text) | Kind::Choice { text, .. } => {
            text.split_whitespace().count() as f64 * 0.3
        }
        Kind::Equation { .. } | Kind::Figure { .. } => 30.0,
        Kind::Fence { .. } => 60.0,
        _ => 0.0,
    };
    let total: f64 = page.blocks.iter().map(|block| seconds(&block.kind)).sum();
    (total / 300.0).ceil().max(1.0) as usize * 5
}

/// An anchor made from a title.
fn anchor(title: &str) -> String {
    let words = title.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}
