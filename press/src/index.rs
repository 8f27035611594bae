//! The index: every term, symbol and item of the library, with the place that defines, explains or prints it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use maud::{Markup, PreEscaped, html};
use regex::{Regex, escape as literally};

use crate::blocks::Kind;
use crate::fault::Faults;
use crate::pages::{Page, anchor};
use crate::prose::{Found, Known, item_link, link, listed};

/// Where a term is defined.
#[derive(Debug)]
pub struct Definition {
    pub path: PathBuf,
    /// The page as faults name it, and the line.
    pub place: (String, usize),
    /// Whether it stands in depth.
    pub deep: bool,
}

/// Terms and where they are defined.
#[derive(Debug, Default)]
pub struct Terms(BTreeMap<String, Definition>);

impl Terms {
    /// The anchor of a term.
    pub fn anchor(term: &str) -> String {
        format!("term:{}", anchor(term))
    }

    /// Adds a definition; a second one of the same term is a fault.
    pub fn define(&mut self, term: &str, definition: Definition, faults: &mut Faults) {
        if let Some(first) = self.0.get(term) {
            let problem = format!("{}:{} defines this term", first.place.0, first.place.1);
            let (file, line) = &definition.place;
            faults.add((file, *line), term, problem, "define it once, and write *…* here");
            return;
        }
        self.0.insert(term.to_owned(), definition);
    }

    /// What the main road uses although only depth defines it.
    pub fn check(&self, pages: &[Page], faults: &mut Faults) {
        for (term, definition) in self.0.iter().filter(|(_, definition)| definition.deep) {
            let word = Regex::new(&format!(r"(?i)\b{}\b", literally(term))).expect("a literal");
            for (page, block) in
                pages.iter().flat_map(|page| page.blocks.iter().map(move |block| (page, block)))
            {
                let Kind::Text(text) = &block.kind else { continue };
                if let Some(found) = word.find(text).filter(|_| block.depth.is_none()) {
                    let line = block.line + text[..found.start()].matches('\n').count();
                    let problem = format!(
                        "the main road uses a term that {}:{} defines in depth",
                        definition.place.0, definition.place.1
                    );
                    let mend = "define it on the main road, or use another word";
                    faults.add((&page.file, line), term, problem, mend);
                }
            }
        }
    }

    /// The terms as a page shows them, letter by letter.
    fn index(&self, here: &Page, pages: &[Page]) -> Markup {
        let mut letters: BTreeMap<String, BTreeMap<_, Markup>> = BTreeMap::new();
        for (term, definition) in &self.0 {
            let page = pages.iter().find(|page| page.path == definition.path);
            let chapter = page.map_or_else(String::new, |page| match &page.number {
                Some(number) => format!("Chapter {number}"),
                None => page.title().to_owned(),
            });
            let entry = link(here, &definition.path, &Terms::anchor(term), term);
            let first = term.chars().find(|c| c.is_alphanumeric()).unwrap_or('#');
            let entries = letters.entry(first.to_uppercase().to_string()).or_default();
            let entry = html! { li { (entry) ", " (chapter) } "\n" };
            entries.insert((term.to_lowercase(), term), entry);
        }
        html! {
            div.index {
                @for (letter, entries) in &letters {
                    h3 { (letter) } "\n"
                    ul { @for entry in entries.values() { (entry) } } "\n"
                }
            }
        }
    }
}

/// The three parts of the index.
pub fn index(here: &Page, pages: &[Page], known: &Known<'_>, found: &Found<'_>) -> String {
    format!(
        "## Terms\n\n{}\n\n## Symbols\n\n{}\n\n## The library\n\n{}\n",
        found.terms.index(here, pages).into_string(),
        found.symbols.index(here, pages).into_string(),
        printed(here, known, found).into_string()
    )
}

/// The items of the library that listings print and algorithms tell.
fn printed(here: &Page, known: &Known<'_>, found: &Found<'_>) -> Markup {
    let place = |(page, id, name): &(PathBuf, String, String)| link(here, page, id, name);
    html! {
        div.index { ul {
            @for (path, places) in &found.printed {
                @if let Some(item) = known.library.item(path) {
                    li {
                        (item_link(here, known.library, item, html! { code { (in_words(path)) } })) ", "
                        (listed(places.iter().map(place)))
                    } "\n"
                }
            }
        } }
    }
}

/// A path that may be broken between its words, and not inside of one.
fn in_words(path: &str) -> Markup {
    PreEscaped(path.replace("::", "::<wbr>").replace('_', "_<wbr>"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_broken_behind_colons_and_underscores() {
        let words = in_words("filter::Msckf::is_lost").into_string();
        assert_eq!(words, "filter::<wbr>Msckf::<wbr>is_<wbr>lost");
    }
}
