//! Equations, their numbers, and the quiet note beside them.

use maud::{Markup, html};

use super::Emitter;
use crate::accepted::normal;
use crate::attributes::Attributes;
use crate::blocks::{Block, Kind};
use crate::exhibits::Check;
use crate::formulas::Formula;
use crate::prose::{equation_html, equation_number, fill};

impl Emitter<'_, '_> {
    pub(super) fn equation(
        &mut self,
        block: &Block,
        tex: &str,
        tex_line: usize,
        attributes: &Attributes,
    ) {
        let place = (self.page.file.as_str(), tex_line);
        self.found.lint.tex(place, &self.page.owner, tex, &mut self.found.faults);
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
            return self.lines(&block.indent, &equation_html("", &filled, ""));
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
        let beside = format!("{}{mark}\n", equation_number(&format!("#{id}"), number));
        let html = equation_html(&format!(" id=\"{id}\""), &filled, &beside);
        self.lines(&block.indent, &html);
    }

    fn definition(&mut self, line: usize, id: &str) -> String {
        if self.known.exhibits.check(&self.page.owner, &id[3..]).is_some() {
            self.fault(
                line,
                id,
                "a definition has nothing to check, and this one has a check",
                "drop .definition, or the check",
            );
        }
        let report = self.known.reports.on(id, &self.page.file);
        html! { p.definition-mark.margin { "definition" (reported(report.as_deref())) } }
            .into_string()
    }

    fn check(&mut self, line: usize, id: &str, tex: &str) -> String {
        let (slug, label) = (self.page.owner.clone(), &id[3..]);
        let Some(check) = self.known.exhibits.check(&slug, label).cloned() else {
            self.fault(line, id, "no check computes this equation", format!("write `fn {}` in exhibits/src/{slug}.rs and register it, or mark the equation {{#{id} .definition}}", label.replace('-', "_")));
            return String::new();
        };
        let accepted = self.known.accepted;
        let held = |slug: &str| accepted.get(slug).and_then(|held| held.equations.get(label));
        let elsewhere =
            accepted.keys().find(|slug| held(slug).is_some_and(|tex_| *tex_ == normal(tex)));
        match held(&slug) {
            None => {
                let (problem, mend) = match elsewhere {
                    Some(other) => (
                        format!(
                            "this equation was held against its check in {other}, and has moved"
                        ),
                        "run `cargo book accept --moved`",
                    ),
                    None => (
                        "this equation was never held against its check".to_owned(),
                        "read both, then run `cargo book accept`",
                    ),
                };
                self.fault(line, id, problem, mend);
            }
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
        let (file, line) = check.place();
        let href = self.source(&file, line);
        note(&check, &href, self.known.reports.on(id, &self.page.file).as_deref())
    }

    /// Definitions are what a chapter asks its reader to take; too many, and little is left that a check can reach.
    pub(super) fn definitions(&mut self) {
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
fn note(check: &Check, href: &str, report: Option<&str>) -> String {
    let worst = check.worst.map_or("not a number".to_owned(), |worst| format!("{worst:.0e}"));
    let (states, against, unit) = (check.states, &check.against, unit(&check.unit));
    let (tolerance, mutants) = (check.tolerance, check.mutants.join(", "));
    let said = format!(
        "Largest error {worst}{unit}, tolerance {tolerance:.0e}{unit}, over {states} states, against {against}. The check rejects {} wrong formulas: {mutants}. ",
        check.mutants.len()
    );
    let note = html! {
        details.check.margin {
            summary { "checked: " span.quantity { (worst) } " over " (states) " states" }
            p {
                (said) a href=(href) { "Its code" } (reported(report))
            }
        }
    };
    note.into_string()
}

/// Where an error in an equation is reported, if there is such a place.
fn reported(address: Option<&str>) -> Markup {
    html! { @if let Some(address) = address { ". " a href=(address) { "Report an error in it" } } }
}

/// The unit of an error as it follows the number; nothing for a relative one.
pub(super) fn unit(unit: &str) -> String {
    match unit {
        "" | "relative" | "no unit" => String::new(),
        unit => format!("\u{a0}{unit}"),
    }
}
