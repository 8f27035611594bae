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

    /// The mutants that the check did not reject; there should be none.
    pub fn survivors(&self) -> Vec<&'static str> {
        let comparisons = (self.check_mutants)();
        let judged = self.mutants.iter().zip(comparisons);
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

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use super::{Chapter, Equation, counterexample_failure, text};
    use crate::book;
    use crate::comparison::Comparison;

    type Formula = fn(f64) -> f64;

    fn doubles(formula: Formula) -> Comparison {
        let mut comparison = Comparison::absolute("a sum", 1e-12, "m");
        comparison.add(&[formula(3.0)], &[3.0 + 3.0]);
        comparison
    }

    /// An equation of the book with what its formula and its mutants are found to be off by.
    struct Checked {
        label: String,
        formula: Comparison,
        mutants: Vec<(&'static str, Comparison)>,
    }

    /// Every equation of the book, checked once for all tests.
    fn checked() -> &'static [Checked] {
        static CHECKED: LazyLock<Vec<Checked>> = LazyLock::new(|| {
            let of = |slug, equation: &Equation| Checked {
                label: format!("{slug}/{}", equation.label),
                formula: equation.check(),
                mutants: equation.mutants.iter().copied().zip((equation.check_mutants)()).collect(),
            };
            let equations = book().iter().flat_map(|c| c.equations.iter().map(|e| of(c.slug, e)));
            equations.collect()
        });
        &CHECKED
    }

    #[test]
    fn every_equation_of_the_book_passes_its_check() {
        for Checked { label, formula, .. } in checked() {
            assert_eq!(formula.failure(), None, "{label}");
            assert!(formula.states >= 20, "{label} is compared at too few states");
        }
    }

    #[test]
    fn every_check_of_the_book_rejects_all_its_mutants_by_a_number() {
        for Checked { label, formula, mutants } in checked() {
            assert!(mutants.len() >= 2, "{label} has too few mutants");
            for (name, mutant) in mutants {
                assert!(mutant.failure().is_some(), "{label}, {name} survives");
                assert!(mutant.worst > 5.0 * formula.tolerance, "{label}, {name}");
            }
        }
    }

    #[test]
    fn every_theorem_of_the_book_needs_its_conditions() {
        for chapter in book() {
            for case in &chapter.counterexamples {
                let label = format!("{}, {}", case.theorem, case.condition);
                assert_eq!(counterexample_failure(&case.comparisons()), None, "{label}");
            }
        }
    }

    #[test]
    fn a_condition_that_is_not_needed_is_found() {
        let chapter = Chapter::registered("test", |chapter| {
            let statement = |x: f64| {
                let mut comparison = Comparison::absolute("its absolute value", 1e-12, "m");
                comparison.add(&[x.abs()], &[x]);
                comparison
            };
            chapter.counterexample("absolute", "positive", statement, [1.0, -1.0]);
            chapter.counterexample("absolute", "whole", statement, [1.0, 1.5]);
            chapter.counterexample("absolute", "negative", statement, [-1.0, 1.0]);
        });
        let failures: Vec<_> = chapter
            .unwrap()
            .counterexamples
            .iter()
            .map(|case| counterexample_failure(&case.comparisons()))
            .collect();
        assert_eq!(failures[0], None);
        assert!(failures[1].as_ref().unwrap().contains("without the condition just as well"));
        assert!(failures[2].as_ref().unwrap().starts_with("with the condition, the error"));
    }

    #[test]
    fn a_mutant_that_passes_is_named_as_a_survivor() {
        let chapter = Chapter::registered("test", |chapter| {
            let mutants: [(_, Formula); 2] = [("sign", |x| -2.0 * x), ("none", |x| x + x)];
            chapter.equation("double", doubles, |x| 2.0 * x, &mutants);
        });
        assert_eq!(chapter.unwrap().equations[0].survivors(), ["none"]);
    }

    #[test]
    fn a_name_used_twice_is_refused_with_both_places() {
        let equations = Chapter::registered("test", |chapter| {
            chapter.equation("double", doubles, |x| 2.0 * x, &[]);
            chapter.equation("double", doubles, |x| 2.0 * x, &[]);
        });
        let sentence = equations.err().unwrap();
        assert!(sentence.contains("equation `double` is registered already at"), "{sentence}");
        assert!(sentence.starts_with("exhibits/src/chapter.rs:"), "{sentence}");

        let numbers = Chapter::registered("test", |chapter| {
            chapter.number("depth", 1.0, "m", 0);
            chapter.number("depth", 2.0, "m", 0);
        });
        assert!(numbers.err().unwrap().contains("number `depth`"));
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused() {
        let chapter = Chapter::registered("test", |chapter| {
            chapter.number("depth", f64::NAN, "m", 0);
        });
        assert!(chapter.err().unwrap().contains("number `depth` is NaN"));
    }

    #[test]
    fn an_equation_and_a_number_may_share_a_name() {
        let chapter = Chapter::registered("test", |chapter| {
            chapter.equation("disparity", doubles, |x| 2.0 * x, &[]);
            chapter.number("disparity", 40.0, "px", 0);
        });
        assert!(chapter.is_ok());
    }

    #[test]
    fn numbers_are_printed_as_in_print() {
        assert_eq!(text(40.0, 0), "40");
        assert_eq!(text(-0.1, 1), "\u{2212}0.1");
        assert_eq!(text(-0.001, 1), "0.0");
        assert_eq!(text(1600.0, 0), "1600");
        assert_eq!(text(10_000_000.0, 0), "10,000,000");
        assert_eq!(text(12345.678, 2), "12,345.68");
    }
}
