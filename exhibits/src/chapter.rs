//! What a chapter shows: where its equations, numbers, figures and records are registered.

use std::collections::HashMap;
use std::panic::Location;

use crate::comparison::Comparison;
use crate::data::{DataFile, NotMade};
use crate::figure::Figure;
use crate::record::{Record, RecordValue, Run, inputs_of, missing};

/// Where in the source something is registered.
#[derive(Clone)]
pub struct Place {
    pub file: String,
    pub line: u32,
}

impl Place {
    #[track_caller]
    fn of_caller() -> Self {
        let location = Location::caller();
        Self { file: location.file().replace('\\', "/"), line: location.line() }
    }
}

/// Comparisons that are made when they are asked for.
type Compared<T> = Box<dyn Fn() -> T + Send + Sync>;

/// An equation of the book with the check of its formula and the wrong formulas that the check must
/// reject.
pub struct Equation {
    pub label: &'static str,
    pub place: Place,
    pub mutants: Vec<&'static str>,
    check: Compared<Comparison>,
    check_mutants: Compared<Vec<Comparison>>,
}

impl Equation {
    /// Compares the formula with its oracle.
    pub fn check(&self) -> Comparison {
        (self.check)()
    }

    /// Compares each mutant with the oracle.
    pub fn check_mutants(&self) -> Vec<Comparison> {
        (self.check_mutants)()
    }

    /// The mutants that the check did not reject; there should be none.
    pub fn survivors(&self) -> Vec<&'static str> {
        let judged = self.mutants.iter().zip(self.check_mutants());
        judged
            .filter(|(_, comparison)| comparison.failure().is_none())
            .map(|(name, _)| *name)
            .collect()
    }
}

/// A condition of a theorem, with a case that keeps it, where the statement holds, and one that does not.
pub struct Counterexample {
    pub theorem: &'static str,
    pub condition: &'static str,
    pub place: Place,
    kept: Compared<Comparison>,
    dropped: Compared<Comparison>,
}

impl Counterexample {
    /// How far off the statement is with the condition and without it.
    pub fn comparisons(&self) -> [Comparison; 2] {
        [(self.kept)(), (self.dropped)()]
    }
}

/// What is wrong with a counterexample: the statement has to hold with the condition, and to be off by several
/// tolerances without it.
pub fn counterexample_failure([kept, dropped]: &[Comparison; 2]) -> Option<String> {
    kept.failure().map(|failure| format!("with the condition, {failure}")).or_else(|| {
        let holds = dropped.worst <= 5.0 * dropped.tolerance;
        holds.then(|| "the statement holds without the condition just as well".to_owned())
    })
}

/// A number that a sentence of the book may quote.
pub struct Number {
    pub name: &'static str,
    pub value: f64,
    pub text: String,
    pub unit: &'static str,
    pub place: Place,
}

/// A figure's name and the function that draws it.
pub struct NamedFigure {
    pub name: &'static str,
    pub draw: fn() -> Figure,
    pub place: Place,
}

/// The exhibits of one chapter. Its numbers are computed at once; nothing is checked, drawn or run
/// before it is asked for.
pub struct Chapter {
    pub slug: &'static str,
    pub equations: Vec<Equation>,
    pub counterexamples: Vec<Counterexample>,
    pub numbers: Vec<Number>,
    pub figures: Vec<NamedFigure>,
    pub records: Vec<Record>,
}

impl Chapter {
    /// The chapter `slug` with all that `register` adds to it, or a sentence about a name that it
    /// uses twice or a number that is not finite.
    pub fn registered(
        slug: &'static str,
        register: impl FnOnce(&mut Self),
    ) -> Result<Self, String> {
        let mut chapter = Self {
            slug,
            equations: Vec::new(),
            counterexamples: Vec::new(),
            numbers: Vec::new(),
            figures: Vec::new(),
            records: Vec::new(),
        };
        register(&mut chapter);
        let wrong = chapter.numbers.iter().find(|n| !n.value.is_finite());
        // What is computed from a record that is not there is nothing, and what is missing is said later.
        if let Some(number) = wrong.filter(|_| missing().is_ok()) {
            let Number { name, value, place, .. } = number;
            let (file, line) = (&place.file, place.line);
            return Err(format!("{file}:{line}: number `{name}` is {value}; mend its computation"));
        }
        refuse_duplicates("equation", chapter.equations.iter().map(|e| (e.label, &e.place)))?;
        refuse_duplicates("number", chapter.numbers.iter().map(|n| (n.name, &n.place)))?;
        refuse_duplicates("figure", chapter.figures.iter().map(|f| (f.name, &f.place)))?;
        refuse_duplicates("record", chapter.records.iter().map(|r| (r.name, &r.place)))?;
        Ok(chapter)
    }

    /// Registers an equation. Its formula is a parameter of `check`, so that the check can also be
    /// shown `mutants`, each with what is wrong with it, and must reject them.
    #[track_caller]
    pub fn equation<F: Copy + Send + Sync + 'static>(
        &mut self,
        label: &'static str,
        check: fn(F) -> Comparison,
        formula: F,
        mutants: &[(&'static str, F)],
    ) {
        let (names, wrong_formulas): (Vec<_>, Vec<F>) = mutants.iter().copied().unzip();
        self.equations.push(Equation {
            label,
            place: Place::of_caller(),
            mutants: names,
            check: Box::new(move || check(formula)),
            check_mutants: Box::new(move || wrong_formulas.iter().map(|f| check(*f)).collect()),
        });
    }

    /// Registers a counterexample. `statement` tries what the theorem says on a case; it must find it true on the
    /// case that keeps the condition and false on the one that drops it.
    #[track_caller]
    pub fn counterexample<C: Copy + Send + Sync + 'static>(
        &mut self,
        theorem: &'static str,
        condition: &'static str,
        statement: fn(C) -> Comparison,
        [kept, dropped]: [C; 2],
    ) {
        self.counterexamples.push(Counterexample {
            theorem,
            condition,
            place: Place::of_caller(),
            kept: Box::new(move || statement(kept)),
            dropped: Box::new(move || statement(dropped)),
        });
    }

    /// Registers a number, to be printed with this many digits after the decimal point.
    #[track_caller]
    pub fn number(&mut self, name: &'static str, value: f64, unit: &'static str, decimals: usize) {
        let text = text(value, decimals);
        self.numbers.push(Number { name, value, text, unit, place: Place::of_caller() });
    }

    /// Registers a figure.
    #[track_caller]
    pub fn figure(&mut self, name: &'static str, draw: fn() -> Figure) {
        self.figures.push(NamedFigure { name, draw, place: Place::of_caller() });
    }

    /// Registers a record: a long run and the inputs that determine its outcome.
    #[track_caller]
    pub fn record(
        &mut self,
        name: &'static str,
        inputs: Vec<(&'static str, String)>,
        run: fn() -> Vec<RecordValue>,
    ) {
        let run = Run::Program(run);
        self.records.push(Record { name, inputs, run, place: Place::of_caller() });
    }

    /// Registers a record that is made from data, whose files are among its inputs.
    #[track_caller]
    pub fn record_of_data(
        &mut self,
        name: &'static str,
        files: &[DataFile],
        mut inputs: Vec<(&'static str, String)>,
        run: fn() -> Result<Vec<RecordValue>, NotMade>,
    ) {
        inputs.extend(inputs_of(files));
        let run = Run::Data(run);
        self.records.push(Record { name, inputs, run, place: Place::of_caller() });
    }
}

fn refuse_duplicates<'a>(
    kind: &str,
    entries: impl Iterator<Item = (&'static str, &'a Place)>,
) -> Result<(), String> {
    let mut seen: HashMap<&str, &Place> = HashMap::new();
    for (name, place) in entries {
        if let Some(first) = seen.insert(name, place) {
            return Err(format!(
                "{}:{}: {kind} `{name}` is registered already at {}:{}; rename one of them",
                place.file, place.line, first.file, first.line
            ));
        }
    }
    Ok(())
}

/// A number as the book prints it: a true minus sign, and commas between thousands from 10,000 on.
pub fn text(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    let sign = if value < 0.0 && !is_zero { "\u{2212}" } else { "" };
    let mut grouped = String::new();
    for (index, digit) in whole.chars().enumerate() {
        let remaining = whole.len() - index;
        if index > 0 && remaining % 3 == 0 && whole.len() > 4 {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    format!("{sign}{grouped}{fraction}")
}
