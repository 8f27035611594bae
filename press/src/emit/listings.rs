//! Blocks of code: listings cut out of compiled sources, and what is not Rust.

use std::path::Path;

use maud::html;
use regex::Captures;

use super::Emitter;
use crate::api::items::Item;
use crate::attributes::Attributes;
use crate::blocks::Block;
use crate::files;
use crate::inline::{NAMED_LABEL, NAMED_WORKS};
use crate::listing::{self, Listing};
use crate::pages::slashed;
use crate::prose::{item_link, listed, name_of};

impl Emitter<'_, '_> {
    pub(super) fn fence(
        &mut self,
        block: &Block,
        language: &str,
        attributes: &Attributes,
        body: &[String],
    ) {
        let include = match body {
            [line] => {
                line.trim().strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}"))
            }
            _ => None,
        };
        match (include, language) {
            (Some(target), language) if language != "rust" && attributes.id.is_empty() => {
                if let Some((_, cut)) = self.cut(block, "", target.trim()) {
                    self.code(block, language, &cut.code);
                }
            }
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
            (None, _) => self.code(block, language, body),
        }
    }

    /// A block of code without a number.
    fn code(&mut self, block: &Block, language: &str, body: &[String]) {
        let ticks = |line: &String| line.len() - line.trim_start_matches('`').len();
        let longest = body.iter().map(ticks).max().unwrap_or(0);
        let mark = "`".repeat(longest.max(2) + 1);
        let text = format!("{mark}{language}\n{}\n{mark}\n", body.join("\n"));
        self.lines(&block.indent, &text);
    }

    fn listing(&mut self, block: &Block, language: &str, attributes: &Attributes, target: &str) {
        if !self.labelled(block.line, attributes, "lst:", "a listing") {
            return;
        }
        let id = &attributes.id;
        let Some((file, cut)) = self.cut(block, id, target) else {
            return self.missing(id);
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
        self.labels_in(block.line, id, &file, &cut.code);
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
        let items = self.items(block, id, (&file, cut.first, cut.last));
        let html = format!(
            "<figure class=\"listing\" id=\"{id}\">\n<figcaption>\n\n**Listing {}.** {caption} <a class=\"source\" href=\"{href}\">{file}, lines\u{a0}{}–\u{2060}{}</a>{items}\n\n</figcaption>\n\n```{language},ignore\n{}\n```\n\n</figure>\n",
            block.number,
            cut.first,
            cut.last,
            self.readable(&cut.code),
        );
        self.lines(&block.indent, &html);
    }

    /// Code whose comments name equations by their numbers and works by their authors.
    fn readable(&self, code: &[String]) -> String {
        let label = |found: &Captures<'_>| match self.known.labels.get(&found[1]) {
            Some(target) => name_of(&found[1], target, false),
            None => found[0].to_owned(),
        };
        let works = |found: &Captures<'_>| {
            let before = found.get(1).map_or("", |before| before.as_str());
            let keys = found.get(2).or(found.get(3)).map_or("", |keys| keys.as_str());
            let name = |key: &str| {
                let work = self.known.bibliography.get(key)?;
                Some(if before.is_empty() { work.narrative.as_str() } else { work.short.as_str() })
            };
            match keys.split("; @").map(name).collect::<Option<Vec<_>>>() {
                Some(names) => format!("{before}{}", names.join("; ")),
                None => found[0].to_owned(),
            }
        };
        let line = |text: &String| match text.trim_start().starts_with("//") {
            true => {
                NAMED_WORKS.replace_all(&NAMED_LABEL.replace_all(text, label), works).into_owned()
            }
            false => text.clone(),
        };
        code.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// The piece of a file that an include asks for, and the file.
    pub(super) fn cut(
        &mut self,
        block: &Block,
        id: &str,
        target: &str,
    ) -> Option<(String, Listing)> {
        let (path, name) = target.rsplit_once(':').unwrap_or((target, ""));
        let Some(file) = self.included(path) else {
            self.fault(
                block.line,
                id,
                format!("{path} is not a file of the book"),
                "mend the path, which begins at the chapter's folder",
            );
            return None;
        };
        let text = files::read(&self.layout.root.join(&file)).ok();
        let Some(cut) = text.and_then(|text| listing::cut(&text, name)) else {
            self.fault(
                block.line,
                id,
                format!("{file} has no anchor `{name}`"),
                format!("enclose the code in // ANCHOR: {name} and // ANCHOR_END: {name}"),
            );
            return None;
        };
        Some((file, cut))
    }

    /// Links to the pages of the public items that stand in full on these lines.
    fn items(
        &mut self,
        block: &Block,
        id: &str,
        (file, first, last): (&str, usize, usize),
    ) -> String {
        let library = self.known.library;
        let shown = library.shown(file, first, last);
        for item in &shown {
            self.shows(item, id, format!("Listing\u{a0}{}", block.number));
        }
        let link = |item: &&Item| {
            let name = item.path.rsplit("::").next().unwrap_or_default();
            item_link(self.page, library, item, name)
        };
        let links = html! { " " span.source { "API:\u{a0}" (listed(shown.iter().map(link))) } };
        if shown.is_empty() { String::new() } else { links.into_string() }
    }

    /// Notes for the index that something with a label shows an item.
    pub(super) fn shows(&mut self, item: &Item, id: &str, name: String) {
        let place = (self.page.path.clone(), id.to_owned(), name);
        self.found.printed.entry(item.path.clone()).or_default().push(place);
    }

    /// Looks up the labels that printed code names, as in `Implements {eq:projection}`; those in descriptions of the
    /// library are looked up where its pages are made.
    fn labels_in(&mut self, line: usize, id: &str, file: &str, code: &[String]) {
        let described = self.known.library.files.iter().any(|known| known.name == file);
        let elsewhere = |text: &&String| !(described && text.trim_start().starts_with("///"));
        let named = code.iter().filter(elsewhere).flat_map(|text| NAMED_LABEL.captures_iter(text));
        for found in named {
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
        let folder = Path::new("src").join(self.page.path.parent()?);
        let file = slashed(&files::joined(&folder, path)?);
        self.layout.root.join(&file).is_file().then_some(file)
    }
}
