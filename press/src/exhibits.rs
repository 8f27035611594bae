//! What the program `exhibits` computed: checks, numbers, figures, records.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde::Deserialize;

use crate::fault::Faults;
use crate::files;
use crate::records::Record;
use crate::settings::Layout;

/// All that one chapter shows, as the program wrote it.
#[derive(Clone, Debug, Deserialize)]
pub struct Shown {
    /// The chapter.
    pub slug: String,
    /// The checks of its equations.
    pub equations: Vec<Check>,
    /// What becomes of its theorems without their conditions.
    pub counterexamples: Vec<Counterexample>,
    /// Its numbers.
    pub numbers: Vec<Number>,
    /// Its figures.
    pub figures: Vec<Drawing>,
    /// The records it stands on.
    pub records: Vec<Inputs>,
    /// The values of records that its figures and numbers show, each as `record.value`.
    #[serde(default)]
    pub asked: Vec<String>,
}

/// The outcome of the check of one equation.
#[derive(Clone, Debug, Deserialize)]
pub struct Check {
    /// The label of the equation, without `eq:`.
    pub label: String,
    /// The largest error; none when it is not a number.
    pub worst: Option<f64>,
    /// What the error may be at most.
    pub tolerance: f64,
    /// The unit of both; `relative` for none.
    pub unit: String,
    /// How many random states were compared.
    pub states: usize,
    /// What the equation was compared with.
    pub against: String,
    /// Why the check failed, if it did.
    pub failure: Option<String>,
    /// The wrong formulas that the check was tried on.
    pub mutants: Vec<String>,
    /// Those of them that it did not reject.
    pub survivors: Vec<String>,
    /// Where it is registered.
    pub file: String,
    /// The line of that.
    pub line: usize,
    /// The line of its function in the same file, when there is one.
    #[serde(skip)]
    pub function: Option<usize>,
}

impl Check {
    /// The file and line that a link to the check leads to.
    pub fn place(&self) -> (String, usize) {
        (self.file.clone(), self.function.unwrap_or(self.line))
    }
}

/// A case in which a theorem fails because one of its conditions is dropped.
#[derive(Clone, Debug, Deserialize)]
pub struct Counterexample {
    /// The label of the theorem, without `thm:`.
    pub theorem: String,
    /// The name of the condition.
    pub condition: String,
    /// How far off the statement is with the condition.
    pub kept: f64,
    /// How far off it is without.
    pub dropped: f64,
    /// What it may be off by.
    pub tolerance: f64,
    /// The unit of all three; `relative` for none.
    pub unit: String,
    /// What the statement was compared with.
    pub against: String,
    /// Why it shows nothing, if it does not.
    pub failure: Option<String>,
    /// Where it is registered.
    pub file: String,
    /// The line of that.
    pub line: usize,
}

/// A computed number.
#[derive(Clone, Debug, Deserialize)]
pub struct Number {
    /// Its name in the chapter.
    pub name: String,
    /// The number itself; none when it is not finite.
    pub value: Option<f64>,
    /// As it stands in prose, without its unit.
    pub text: String,
    /// Its unit, for the ledger.
    pub unit: String,
    /// Where it is computed.
    pub file: String,
    /// The line of that.
    pub line: usize,
}

/// A drawn figure and its data.
#[derive(Clone, Debug, Deserialize)]
pub struct Drawing {
    /// Its name in the chapter; `<name>.svg` and `<name>.csv` lie beside.
    pub name: String,
    /// The headings of its data.
    pub columns: Vec<String>,
    /// The rows of its data.
    pub rows: Vec<Vec<String>>,
    /// Its rectangles that lead to another place of the book.
    #[serde(default)]
    pub links: Vec<Link>,
    /// Where it is drawn.
    pub file: String,
    /// The line of that.
    pub line: usize,
}

/// A rectangle of a figure that leads to another place of the book.
#[derive(Clone, Debug, Deserialize)]
pub struct Link {
    /// What it stands for.
    pub name: String,
    /// The label of the place.
    pub to: String,
    /// What is written before the name of the place.
    pub before: String,
    /// Left and upper edge, in units of the view box.
    pub corner: (i32, i32),
    /// Width and height, in the same units.
    pub size: (i32, i32),
}

/// What a record is made from.
#[derive(Clone, Debug, Deserialize)]
pub struct Inputs {
    /// The name of the record.
    pub name: String,
    /// Its inputs by name.
    pub inputs: BTreeMap<String, String>,
    /// Where it is made.
    pub file: String,
    /// The line of that.
    pub line: usize,
}

/// All exhibits of the book.
#[derive(Clone, Debug, Default)]
pub struct Exhibits {
    /// What each chapter shows, by slug.
    pub chapters: BTreeMap<String, Shown>,
    /// The accepted records, by name.
    pub records: BTreeMap<String, Record>,
    folder: PathBuf,
}

impl Exhibits {
    /// Reads what the program wrote for the chapters `slugs`, and the records.
    pub fn read(layout: &Layout, slugs: &[String]) -> Result<Exhibits> {
        let folder = layout.exhibits();
        let mut chapters = BTreeMap::new();
        for slug in slugs {
            let path = folder.join(slug).join("exhibits.json");
            if let Some(text) = files::read_if_there(&path)? {
                let mut shown: Shown = serde_json::from_str(&text).with_context(|| {
                    format!("{} is damaged: delete it and build again", path.display())
                })?;
                let mut sources = BTreeMap::new();
                for check in &mut shown.equations {
                    let source = match sources.entry(check.file.clone()) {
                        Entry::Occupied(known) => known.into_mut(),
                        Entry::Vacant(new) => {
                            let source = files::read_if_there(&layout.root.join(&check.file))?;
                            new.insert(source.unwrap_or_default())
                        }
                    };
                    check.function = function_line(source, &check.label);
                }
                chapters.insert(slug.clone(), shown);
            }
        }
        Ok(Exhibits { chapters, records: Record::read_all(&layout.records())?, folder })
    }

    /// The check of an equation of a chapter.
    pub fn check(&self, slug: &str, label: &str) -> Option<&Check> {
        self.chapters.get(slug)?.equations.iter().find(|check| check.label == label)
    }

    /// All counterexamples.
    pub fn counterexamples(&self) -> impl Iterator<Item = &Counterexample> {
        self.chapters.values().flat_map(|shown| &shown.counterexamples)
    }

    /// The counterexample to a theorem without one of its conditions.
    pub fn counterexample(&self, theorem: &str, condition: &str) -> Option<&Counterexample> {
        self.counterexamples().find(|case| case.theorem == theorem && case.condition == condition)
    }

    /// The figure `chapter/name` and the folder it lies in.
    pub fn drawing(&self, slug: &str, name: &str) -> Option<(&Drawing, PathBuf)> {
        let drawing = self.chapters.get(slug)?.figures.iter().find(|figure| figure.name == name)?;
        Some((drawing, self.folder.join(slug)))
    }

    /// The number `chapter.name` or `record.name` as text.
    pub fn number(&self, name: &str) -> Option<(Option<f64>, &str)> {
        let (owner, name) = name.split_once('.')?;
        if let Some(shown) = self.chapters.get(owner) {
            return shown
                .numbers
                .iter()
                .find(|number| number.name == name)
                .map(|number| (number.value, number.text.as_str()));
        }
        let value = self.records.get(owner)?.values.get(name)?;
        Some((Some(value.value), value.text.as_str()))
    }

    /// Why there is no number `chapter.name` or `record.name`, which a page of the chapter `slug` asks for, and what
    /// to do.
    pub fn why_no_number(&self, name: &str, slug: &str) -> (String, String) {
        let (owner, value) = name.split_once('.').unwrap_or((slug, name));
        let problem = match self.records.contains_key(owner) {
            true => format!("the accepted record `{owner}` has no value `{value}`"),
            false if self.is_made(owner) => format!("the record `{owner}` was never accepted"),
            false => {
                return (
                    "no program computes this number".to_owned(),
                    format!("register it in exhibits/src/{owner}.rs, or mend the name"),
                );
            }
        };
        (
            problem,
            format!("run `cargo book record {owner}`, then `cargo book accept`, or mend the name"),
        )
    }

    /// Whether a program makes a record of this name.
    fn is_made(&self, record: &str) -> bool {
        self.chapters.values().flat_map(|shown| &shown.records).any(|made| made.name == record)
    }

    /// The names of all numbers, with where they are made.
    pub fn number_names(&self) -> Vec<(String, String, usize)> {
        let computed = self.chapters.values().flat_map(|shown| {
            shown.numbers.iter().map(|number| {
                (format!("{}.{}", shown.slug, number.name), number.file.clone(), number.line)
            })
        });
        let recorded = self.records.values().flat_map(|record| {
            record.values.keys().map(|name| (format!("{}.{name}", record.name), record.file(), 0))
        });
        computed.chain(recorded).collect()
    }

    /// Checks that fail, mutants that survive, names that stand twice, records that do not fit their program.
    pub fn faults(&self) -> Faults {
        let mut faults = Faults::default();
        for shown in self.chapters.values() {
            for check in &shown.equations {
                check_faults(check, &mut faults);
            }
            for inputs in &shown.records {
                self.record_faults(inputs, &mut faults);
            }
        }
        for record in self.records.values() {
            self.accepted_faults(record, &mut faults);
        }
        faults
    }

    fn accepted_faults(&self, record: &Record, faults: &mut Faults) {
        let (file, name) = (record.file(), &record.name);
        let place = (file.as_str(), 0);
        if self.chapters.contains_key(name) {
            let problem = "a record has the name of a chapter, so its values cannot be told apart";
            faults.add(place, name, problem, "rename the record");
        }
        if !self.is_made(name) {
            let mend = "register it in exhibits/src/, or delete its file";
            faults.add(place, name, "no program makes this record", mend);
        }
        for (value, said) in record.values.iter().filter(|(_, said)| !said.is_told()) {
            let problem = format!("the text says {}, and the value is {}", said.text, said.value);
            let mend = format!("run `cargo book record {name}`, then `cargo book accept`");
            faults.add(place, format!("{name}.{value}"), problem, mend);
        }
    }

    fn record_faults(&self, made: &Inputs, faults: &mut Faults) {
        let place = (made.file.as_str(), made.line);
        let mend = format!(
            "run `cargo book record {0}`, read what it shows, then `cargo book accept`",
            made.name
        );
        match self.records.get(&made.name) {
            None => faults.add(place, &made.name, "this record was never made", mend),
            Some(record) if record.inputs != made.inputs => {
                faults.add(
                    place,
                    &made.name,
                    "the record was made from other inputs than the program has now",
                    mend,
                );
            }
            Some(_) => {}
        }
    }
}

fn check_faults(check: &Check, faults: &mut Faults) {
    let place = (check.file.as_str(), check.line);
    let label = format!("eq:{}", check.label);
    if let Some(failure) = &check.failure {
        faults.add(
            place,
            &label,
            format!("the check fails: {failure}"),
            "find out which is wrong, the equation, the library or the check, and mend that one",
        );
    }
    for survivor in &check.survivors {
        faults.add(
            place,
            &label,
            format!("the check does not notice the wrong formula “{survivor}”"),
            "compare with something that tells the two apart, or tighten the tolerance",
        );
    }
    if check.mutants.is_empty() {
        faults.add(
            place,
            &label,
            "the check was tried on no wrong formula",
            "give it mutants: a sign, a transpose, a wrong frame, a dropped term",
        );
    }
    if check.function.is_none() {
        let name = check.label.replace('-', "_");
        faults.add(
            place,
            &label,
            format!("{} has no function `{name}`", check.file),
            "name the check's function after the label of its equation",
        );
    }
}

/// The line of the function that checks an equation.
fn function_line(source: &str, label: &str) -> Option<usize> {
    let head = format!("fn {}(", label.replace('-', "_"));
    let begins = |line: &str| line.trim_start().trim_start_matches("pub ").starts_with(&head);
    source.lines().position(begins).map(|line| line + 1)
}
