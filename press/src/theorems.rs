//! Theorems, the conditions that they state, and the counterexamples that show why each is stated.

use std::collections::BTreeMap;

use crate::attributes::Attributes;
use crate::blocks::Kind;
use crate::exhibits::Exhibits;
use crate::fault::Faults;
use crate::inline::{Mark, tokens};
use crate::pages::Page;

/// A theorem and its conditions, each by its name with the words that state it.
#[derive(Debug, Default)]
pub struct Theorem {
    /// The page and line that state it.
    place: (String, usize),
    /// The words of each condition, by name.
    pub conditions: BTreeMap<String, String>,
}

/// All theorems by their labels, without `thm:`.
#[derive(Debug, Default)]
pub struct Theorems(BTreeMap<String, Theorem>);

impl Theorems {
    /// Collects the theorems of all pages; a condition that belongs to none is a fault.
    pub fn collect(pages: &[Page], faults: &mut Faults) -> Theorems {
        let mut theorems = Theorems::default();
        for page in pages {
            let mut open = Vec::new();
            for block in &page.blocks {
                match &block.kind {
                    Kind::Open(attributes) => {
                        open.push(attributes);
                        if let Some(label) = attributes.id.strip_prefix("thm:") {
                            let place = (page.file.clone(), block.line);
                            theorems.0.entry(label.to_owned()).or_default().place = place;
                        }
                    }
                    Kind::Close => drop(open.pop()),
                    Kind::Text(text) => {
                        theorems.conditions(page, block.line, text, open.last(), faults);
                    }
                    _ => {}
                }
            }
        }
        theorems
    }

    /// The theorem of a label.
    pub fn get(&self, label: &str) -> Option<&Theorem> {
        self.0.get(label)
    }

    /// How many theorems there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    fn conditions(
        &mut self,
        page: &Page,
        first: usize,
        text: &str,
        inside: Option<&&Attributes>,
        faults: &mut Faults,
    ) {
        for token in tokens(text) {
            let Mark::Span { text: words, attributes } = &token.mark else { continue };
            let line = first + token.line;
            if !attributes.has("condition") {
                self.conditions(page, line, words, inside, faults);
                continue;
            }
            let name = attributes.value("name");
            let theorem = inside
                .and_then(|division| division.id.strip_prefix("thm:"))
                .and_then(|label| self.0.get_mut(label));
            let (Some(theorem), false) = (theorem, name.is_empty()) else {
                let problem = "a condition has a name, and stands in a theorem";
                let mend = "write [the words]{.condition name=\"…\"} in ::: {.theorem …}";
                faults.add((&page.file, line), *words, problem, mend);
                continue;
            };
            if theorem.conditions.insert(name.to_owned(), (*words).to_owned()).is_some() {
                let problem = "the theorem has a condition of this name already";
                faults.add(
                    (&page.file, line),
                    name,
                    problem,
                    "give each condition a name of its own",
                );
            }
        }
    }

    /// Whether each theorem states conditions, and whether each condition has a counterexample that a page shows
    /// and the program computes, and no other has one.
    pub fn check(&self, pages: &[Page], exhibits: &Exhibits, faults: &mut Faults) {
        let shown: Vec<(&str, &str)> = pages
            .iter()
            .flat_map(|page| &page.blocks)
            .filter_map(|block| match &block.kind {
                Kind::Open(attributes) if attributes.has("counterexample") => {
                    let of = attributes.value("of").trim_start_matches("thm:");
                    Some((of, attributes.value("without")))
                }
                _ => None,
            })
            .collect();
        for (label, theorem) in &self.0 {
            let place = (theorem.place.0.as_str(), theorem.place.1);
            let id = format!("thm:{label}");
            if theorem.conditions.is_empty() {
                let mend = "mark them: [the words]{.condition name=\"…\"}";
                faults.add(place, &id, "the theorem names no conditions", mend);
            }
            for name in theorem.conditions.keys() {
                let times = shown.iter().filter(|case| **case == (label.as_str(), name)).count();
                if times != 1 {
                    let problem = format!("{times} counterexamples drop its condition “{name}”");
                    let mend =
                        format!("show one: ::: {{.counterexample of=\"{id}\" without=\"{name}\"}}");
                    faults.add(place, &id, problem, mend);
                }
            }
        }
        for case in exhibits.counterexamples() {
            let place = (case.file.as_str(), case.line);
            let id = format!("thm:{}, {}", case.theorem, case.condition);
            if !shown.contains(&(&case.theorem, &case.condition)) {
                let mend = "show it, or remove it";
                faults.add(place, &id, "no page shows this counterexample", mend);
            }
            if let Some(failure) = &case.failure {
                let problem = format!("the counterexample shows nothing: {failure}");
                let mend = "find a case that does, or drop the condition from the theorem";
                faults.add(place, &id, problem, mend);
            }
        }
    }
}
