//! Divisions (`:::`): openings, predictions, theorems, proofs, notes.

use maud::{PreEscaped, html};

use super::Emitter;
use super::algorithms::Algorithm;
use crate::attributes::Attributes;
use crate::blocks::{Block, Kind};
use crate::emit::equations::unit;
use crate::inline::{Mark, tokens};
use crate::pages::Page;
use crate::prose::TERMS;
use crate::ways::{fives, seconds};

/// An open `:::` and what was seen in it.
pub(super) struct Division {
    pub(super) line: usize,
    pub(super) class: String,
    id: String,
    right_choices: usize,
    in_choices: bool,
    reveals: usize,
    /// What an algorithm has so far.
    pub(super) algorithm: Option<Algorithm>,
}

impl Emitter<'_, '_> {
    pub(super) fn open(&mut self, block: &Block, attributes: &Attributes) {
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
                "<details class=\"reveal\"><summary><span class=\"screen\">Reveal the </span>answer</summary>\n".to_owned()
            }
            "theorem" => {
                self.labelled(block.line, attributes, "thm:", "a theorem");
                let title = self.resolve(block.line, attributes.value("title"));
                format!(
                    "<div class=\"theorem\" id=\"{id}\">\n<p class=\"theorem-title\">Theorem {} ({title}).</p>\n",
                    block.number
                )
            }
            "counterexample" => self.counterexample(block, attributes),
            "algorithm" => self.algorithm(block, attributes),
            "proof" => "<div class=\"proof\">\n<p class=\"proof-title\">Proof.</p>\n".to_owned(),
            "hint" => {
                let title = self.said(block.line, attributes, "title");
                let text = self.text_of(block, attributes.value("text"));
                format!("<details class=\"reveal\"><summary>Hint: {title}</summary>\n\n{text}\n")
            }
            "note" => "<div class=\"margin note\" role=\"note\">\n".to_owned(),
            "sheet" => "<div class=\"sheet\">\n".to_owned(),
            other => {
                let known = "opening, predict, reveal, theorem, proof, counterexample, algorithm, hint, note, sheet";
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
        let algorithm =
            (class == "algorithm").then(|| Algorithm::of(attributes.value("item"), &block.number));
        self.open.push(Division {
            line: block.line,
            class,
            id: id.clone(),
            right_choices: 0,
            in_choices: false,
            reveals: 0,
            algorithm,
        });
    }

    /// A theorem without one of its conditions, and how far off it then is.
    fn counterexample(&mut self, block: &Block, attributes: &Attributes) -> String {
        let (of, without) = (attributes.value("of"), attributes.value("without"));
        let label = of.trim_start_matches("thm:");
        let known = self.known;
        let words = known.theorems.get(label).and_then(|theorem| theorem.conditions.get(without));
        let case = known.exhibits.counterexample(label, without);
        let (Some(words), Some(case)) = (words, case) else {
            let problem = match words {
                None => "no theorem of this label has a condition of this name",
                Some(_) => "no program computes this counterexample",
            };
            let mend =
                "write of=\"thm:…\" without=\"…\", and register it: chapter.counterexample(…)";
            self.fault(block.line, &format!("{of}, {without}"), problem, mend);
            return "<div class=\"counterexample\">\n".to_owned();
        };
        let pointer = match block.depth {
            Some(_) => format!("@{of}"),
            None => format!("[@{of}]{{.further}}"),
        };
        let theorem = self.resolve(block.line, &pointer);
        let words = self.resolve(block.line, words);
        let href = self.source(&case.file, case.line);
        let unit = unit(&case.unit);
        let off = match case.dropped {
            size @ 0.01..10.0 => format!("{size:.2}"),
            size @ 10.0..10_000.0 => format!("{size:.0}"),
            size => format!("{size:.0e}"),
        };
        let said = format!(
            "Compared with {}, what the theorem says is off by {off}{unit} without the condition and by {:.0e}{unit} with it; the tolerance is {:.0e}{unit}. ",
            case.against, case.kept, case.tolerance,
        );
        let html = html! {
            details.check.margin {
                summary { "off by " span.quantity { (off) (unit) } }
                p { (said) a href=(href) { "Its code" } }
            } "\n"
            p.counterexample-title { (PreEscaped(theorem)) " without “" (PreEscaped(words)) "”." } "\n"
        };
        format!("<div class=\"counterexample\">\n{}", html.into_string())
    }

    /// What a hint says: a piece of a file that the exercise's own program reads too.
    fn text_of(&mut self, block: &Block, target: &str) -> String {
        let text = self.cut(block, "hint", target).map(|(_, piece)| piece.code.join("\n"));
        self.resolve(block.line, &text.unwrap_or_default())
    }

    fn opening(&mut self, line: usize, attributes: &Attributes) -> String {
        let difficulty = self.said(line, attributes, "difficulty");
        let needs = self.said(line, attributes, "needs");
        let [main, all] = seconds(&self.page.blocks).map(fives);
        let road = self.road(attributes.value("needs"));
        let minutes = if all > main { format!("{main} to {all}") } else { main.to_string() };
        format!(
            "<div class=\"opening\" data-main=\"{main}\" data-all=\"{all}\">\n\
             <dl><dt>Difficulty</dt><dd>{difficulty} of 3</dd>\
             <dt>Reading time</dt><dd>{minutes} minutes</dd>\
             <dt>Needs</dt><dd>{needs}</dd>{road}</dl>\n"
        )
    }

    /// Which road an exercise asks for: what it needs may stand in depth.
    fn road(&self, needs: &str) -> String {
        if !self.page.path.starts_with("exercises") {
            return String::new();
        }
        let labels = self.known.labels;
        let deep = tokens(needs).iter().any(|token| match token.mark {
            Mark::Reference { label, .. } => labels.get(label).is_some_and(|target| target.deep),
            _ => false,
        });
        let road = if deep { "the main road and what is in depth" } else { "the main road" };
        format!("<dt>Asks for</dt><dd>{road}</dd>")
    }

    /// Whether this stands on a sheet for looking things up. It is no step of the main road, so it may show what is in
    /// depth.
    pub(super) fn on_sheet(&self) -> bool {
        self.open.iter().any(|division| division.class == "sheet")
    }

    /// What an opening or a hint says of a matter that it must not leave out.
    fn said(&mut self, line: usize, attributes: &Attributes, key: &str) -> String {
        let value = self.resolve(line, attributes.value(key));
        if value.is_empty() {
            self.fault(
                line,
                key,
                format!("the attributes do not say {key}=\"…\""),
                "a reader wants to know before reading",
            );
        }
        value
    }

    pub(super) fn close(&mut self, line: usize) {
        let Some(division) = self.open.pop() else {
            return self.fault(
                line,
                ":::",
                "this closes a division that was never opened",
                "remove it",
            );
        };
        let end = match division.class.as_str() {
            "reveal" | "hint" => "</details>".to_owned(),
            "opening" => format!("</div>\n{}", legend(self.page)),
            "predict" => {
                if division.right_choices != 1 || division.reveals != 1 {
                    self.fault(division.line, &division.id, format!("a prediction has one right choice and one reveal, and this one has {} and {}", division.right_choices, division.reveals), "write the choices as `- [ ] …`, the right one as `- [x] …`, and the answer in ::: reveal");
                }
                "</div>".to_owned()
            }
            "algorithm" => {
                let algorithm = division.algorithm.unwrap_or_default();
                self.end_algorithm(division.line, &division.id, &algorithm)
            }
            "theorem" | "proof" | "counterexample" | "note" | "sheet" => "</div>".to_owned(),
            _ => String::new(),
        };
        self.out.push_str(&format!("\n{end}\n\n"));
    }

    pub(super) fn choice(&mut self, line: usize, right: bool, text: &str) {
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
        // A line of it that begins like an item of a list is none.
        let text = text.replace('\n', " ");
        self.out.push_str(&format!("<li{mark}>\n\n{text}\n\n</li>\n"));
    }

    /// Ends a list of choices when something else than white space follows.
    pub(super) fn end_choices(&mut self, next: &Kind) {
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
