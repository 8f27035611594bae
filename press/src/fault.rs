//! What is wrong with the book, where, and how to mend it.

use std::fmt;

/// A broken promise: one entry of the list that ends a failed build.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fault {
    /// The file as the author knows it, relative to the root of the book.
    pub file: String,
    /// The line in that file, counted from 1; 0 when the fault has no line.
    pub line: usize,
    /// The label or name that the fault is about; may be empty.
    pub label: String,
    /// What is wrong.
    pub problem: String,
    /// What to do about it.
    pub mend: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.file)?;
        if self.line > 0 {
            write!(out, ":{}", self.line)?;
        }
        if !self.label.is_empty() {
            write!(out, ": {}", self.label)?;
        }
        write!(out, ": {}\n    mend: {}", self.problem, self.mend)
    }
}

/// The faults found so far. Nothing stops at the first one: an author wants the whole list.
#[derive(Clone, Debug, Default)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// Notes a fault.
    pub fn add(
        &mut self,
        place: (&str, usize),
        label: impl Into<String>,
        problem: impl Into<String>,
        mend: impl Into<String>,
    ) {
        self.0.push(Fault {
            file: place.0.to_owned(),
            line: place.1,
            label: label.into(),
            problem: problem.into(),
            mend: mend.into(),
        });
    }

    /// Takes over the faults of another list.
    pub fn extend(&mut self, other: Faults) {
        self.0.extend(other.0);
    }

    /// Whether every promise is kept.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The faults in the order of files and lines, each once.
    pub fn sorted(&self) -> Vec<Fault> {
        let mut faults = self.0.clone();
        faults.sort();
        faults.dedup();
        faults
    }

    /// The report that a failed build ends with; empty when there is nothing to report.
    pub fn report(&self) -> String {
        let faults = self.sorted();
        let mut report: String = faults.iter().map(|fault| format!("{fault}\n")).collect();
        match faults.len() {
            0 => {}
            1 => report.push_str("The book breaks one promise; see above.\n"),
            n => report.push_str(&format!("The book breaks {n} promises; see above.\n")),
        }
        report
    }
}
