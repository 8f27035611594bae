//! The index: every term, symbol and item of the library, with the place that defines, explains or prints it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use maud::{Markup, PreEscaped, html};
use regex::{Regex, escape as literally};

use crate::fault::Faults;
use crate::files::joined;
use crate::inline::{Mark, tokens};
use crate::pages::{Labels, Page, anchor};
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

impl Definition {
    /// What is wrong where the main road uses the term without it, and how to mend it.
    fn missed(&self) -> (String, &'static str) {
        let (file, line) = &self.place;
        match self.deep {
            true => (
                format!("the main road uses a term that {file}:{line} defines in depth"),
                "define it on the main road, or use another word",
            ),
            false => (
                format!("the main road uses a term that {file}:{line} defines later"),
                "define it here, link to its chapter in this paragraph, or use another word; an everyday word is marked with its sense: term=\"gain (of a filter)\"",
            ),
        }
    }
}

/// What names a term, in the singular or in the plural. Nothing does where it has its sense in parentheses.
fn naming(term: &str) -> Regex {
    let words: Vec<String> = term.split_whitespace().map(literally).collect();
    Regex::new(&format!(r"(?i)\b{}s?\b", words.join(r"[ \n]+"))).expect("a literal")
}

/// A paragraph of the main road.
#[derive(Default)]
struct Paragraph<'a> {
    /// Its words, without code and formulas, and the line that each stretch of them begins on.
    words: Vec<(usize, &'a str)>,
    /// The pages that its links lead to.
    leads: BTreeSet<PathBuf>,
}

impl<'a> Paragraph<'a> {
    /// The paragraphs of a page that are on the main road.
    fn all(page: &'a Page, labels: &Labels) -> Vec<Self> {
        let mut paragraphs = Vec::new();
        for block in page.blocks.iter().filter(|block| block.depth.is_none()) {
            let mut line = block.line;
            for text in block.said().split("\n\n") {
                let mut paragraph = Self::default();
                paragraph.read(text, line, page, labels);
                paragraphs.push(paragraph);
                line += text.matches('\n').count() + 2;
            }
        }
        paragraphs
    }

    fn read(&mut self, text: &'a str, line: usize, page: &Page, labels: &Labels) {
        static LINK: LazyLock<Regex> =
            LazyLock::new(|| Regex::new(r"\]\(([^)#]+)").expect("a valid pattern"));
        for token in tokens(text) {
            let line = line + token.line;
            match token.mark {
                Mark::Plain(text) => {
                    self.words.push((line, text));
                    let folder = page.path.parent().unwrap_or(Path::new(""));
                    let links = LINK.captures_iter(text);
                    self.leads.extend(links.filter_map(|link| joined(folder, &link[1])));
                }
                Mark::Span { text, .. } | Mark::Item { text, .. } => {
                    self.read(text, line, page, labels);
                }
                Mark::Reference { label, .. } => {
                    self.leads.extend(labels.get(label).map(|target| target.path.clone()));
                }
                _ => {}
            }
        }
    }

    /// The line on which the paragraph has the word, if it does.
    fn line_of(&self, word: &Regex) -> Option<usize> {
        self.words.iter().find_map(|(line, text)| {
            word.find(text).map(|found| line + text[..found.start()].matches('\n').count())
        })
    }
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

    /// What the main road uses although only depth defines it, or a chapter that is still to come. A paragraph that
    /// leads to that chapter may use its terms.
    pub fn check(&self, pages: &[Page], labels: &Labels, faults: &mut Faults) {
        let paragraphs: Vec<Vec<Paragraph<'_>>> =
            pages.iter().map(|page| Paragraph::all(page, labels)).collect();
        for (term, definition) in &self.0 {
            let word = naming(term);
            let chapter = pages.iter().position(|page| page.path == definition.path);
            for (at, page) in pages.iter().enumerate() {
                let early = page.is_chapter() && chapter.is_some_and(|chapter| at < chapter);
                for paragraph in paragraphs[at].iter().filter(|_| early || definition.deep) {
                    let leads = !definition.deep && paragraph.leads.contains(&definition.path);
                    if let Some(line) = paragraph.line_of(&word).filter(|_| !leads) {
                        let (problem, mend) = definition.missed();
                        faults.add((&page.file, line), term, problem, mend);
                    }
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
    use crate::blocks::blocks;

    /// What is said of a first chapter when a second one defines the terms.
    fn said(first: &str) -> String {
        let pages = [("one", first), ("two", "# Two {#sec:two}\n\nHere they are.\n")];
        let pages = pages.map(|(slug, text)| Page {
            file: format!("src/{slug}.md"),
            name: slug.to_owned(),
            path: format!("{slug}.md").into(),
            slug: slug.to_owned(),
            owner: slug.to_owned(),
            number: Some(slug.to_owned()),
            blocks: blocks(text),
        });
        let (mut faults, mut terms) = (Faults::default(), Terms::default());
        let labels = Labels::collect(&pages, &mut faults);
        for term in ["loop closure", "gain (of a filter)"] {
            let place = ("src/two.md".to_owned(), 3);
            let definition = Definition { path: "two.md".into(), place, deep: false };
            terms.define(term, definition, &mut faults);
        }
        terms.check(&pages, &labels, &mut faults);
        faults.report()
    }

    #[test]
    fn a_term_that_a_later_chapter_defines_is_named_with_both_places() {
        let told =
            "src/one.md:4: loop closure: the main road uses a term that src/two.md:3 defines later";
        for early in [
            "# One\n\nThis is\na loop closure.\n",
            "See @sec:two.\n\nThere\nare [two loop\nclosures]{.measured}.\n",
        ] {
            let report = said(early);
            assert!(report.contains(told), "{report}");
        }
    }

    #[test]
    fn a_paragraph_that_leads_to_a_later_chapter_may_use_its_terms() {
        for link in
            ["@sec:two", "[Two](two.md)", "[above](./two.md#sec:two)", "[@sec:two]{.further}"]
        {
            assert_eq!(said(&format!("A loop closure comes in {link}.\n")), "");
        }
    }

    #[test]
    fn code_uses_no_term_and_a_sense_in_parentheses_is_not_looked_for() {
        assert_eq!(said("There is little to gain by `loop closure`.\n"), "");
    }

    #[test]
    fn a_path_is_broken_behind_colons_and_underscores() {
        let words = in_words("filter::Msckf::is_lost").into_string();
        assert_eq!(words, "filter::<wbr>Msckf::<wbr>is_<wbr>lost");
    }
}
