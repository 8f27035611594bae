//! Checks, and what they say when an answer is wrong.

use std::cell::RefCell;
use std::fmt::{self, Debug, Display, Formatter, Write as _};

use nalgebra::{DMatrix, Dim, Matrix, RawStorage};

use crate::answer::{Fault, Transport};
use crate::picture::Picture;

/// A plausible wrong answer: its name, and what to tell a student who gave it.
#[derive(Debug, PartialEq, Eq)]
pub struct Misconception {
    /// One word for reports.
    pub name: &'static str,
    /// What the output shows and a question that leads on, without the answer.
    pub sentence: &'static str,
}

/// Declares misconceptions: a constant, its name and its sentence.
#[macro_export]
macro_rules! misconceptions {
    ($($constant:ident, $name:literal: $sentence:literal;)+) => {
        $(
            #[doc = $sentence]
            pub static $constant: $crate::check::Misconception =
                $crate::check::Misconception { name: $name, sentence: $sentence };
        )+

        /// Every misconception of the exercise.
        pub const MISCONCEPTIONS: &[&$crate::check::Misconception] = &[$(&$constant),+];
    };
}

/// One thing that an answer must do, on instances that were drawn already.
pub struct Check {
    /// What it states, as the name of a test.
    pub name: &'static str,
    run: Box<Run>,
}

/// What a check does with an answer.
type Run = dyn Fn(&dyn Transport) -> Result<(), Failure> + Send + Sync;

impl Check {
    /// A check from its statement and what it does.
    pub fn new(
        name: &'static str,
        run: impl Fn(&dyn Transport) -> Result<(), Failure> + Send + Sync + 'static,
    ) -> Self {
        Self { name, run: Box::new(run) }
    }

    /// Runs it on an answer.
    ///
    /// # Errors
    ///
    /// A [`Failure`] when the answer is wrong.
    pub fn run(&self, answer: &dyn Transport) -> Result<(), Failure> {
        (self.run)(answer)
    }

    /// Runs it on an answer to see all that it compares, whatever comes out: a number that is not
    /// as it should be does not end it. Gives what else is wrong, too.
    pub fn watch(&self, answer: &dyn Transport) -> (Vec<Compared>, Option<Failure>) {
        WATCHED.set(Some(Vec::new()));
        let failure = self.run(answer).err();
        (WATCHED.take().unwrap_or_default(), failure)
    }
}

thread_local! {
    /// What has been compared, while somebody watches.
    static WATCHED: RefCell<Option<Vec<Compared>>> = const { RefCell::new(None) };
}

/// What a check compared while it was watched.
#[derive(Debug, Clone)]
pub struct Compared {
    /// What the numbers are.
    pub what: String,
    /// Those of the answer.
    pub obtained: DMatrix<f64>,
    /// Those of the oracle.
    pub expected: DMatrix<f64>,
    /// How far entries may be off, as a part of the greatest one expected.
    pub tolerance: f64,
    /// Names of rows; there may be none.
    pub rows: Vec<String>,
    /// Names of columns; there may be none.
    pub columns: Vec<String>,
    /// What is wrong.
    pub failure: Option<Failure>,
}

/// Shows numbers of an answer beside others to whoever watches. It judges nothing: that is for checks
/// whose verdict is not a comparison of numbers.
pub fn show(what: &str, obtained: &DMatrix<f64>, expected: &DMatrix<f64>) {
    if WATCHED.with_borrow(Option::is_some) {
        // Whoever watches hears of it, and nothing comes back.
        let _ = compare(what, obtained, expected).judge();
    }
}

/// The same for lists.
pub fn show_list(what: &str, obtained: &[f64], expected: &[f64]) {
    show(what, &column(obtained), &column(expected));
}

/// Why an answer fails a check, in words of the subject.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// What is wrong.
    pub sentence: String,
    /// The same without the words of the answer, if it has said any. They could be its input.
    pub quiet: Option<String>,
    /// Numbers expected and obtained, in lines; may be empty.
    pub numbers: String,
    /// The misconception that gives these numbers, if one does.
    pub misconception: Option<&'static Misconception>,
    /// Expected and obtained side by side, where that can be drawn.
    pub picture: Option<Box<Picture>>,
    /// Whether an earlier function has to be right first.
    pub waits: bool,
}

impl Failure {
    /// A failure that is told in a sentence.
    pub fn new(sentence: impl Into<String>) -> Self {
        Self {
            sentence: sentence.into(),
            quiet: None,
            numbers: String::new(),
            misconception: None,
            picture: None,
            waits: false,
        }
    }

    /// A failure that is known.
    pub fn known(misconception: &'static Misconception) -> Self {
        Self { misconception: Some(misconception), ..Self::new(misconception.sentence) }
    }

    /// The same with a sentence that repeats nothing of what the answer said.
    pub fn or_quietly(self, sentence: impl Into<String>) -> Self {
        Self { quiet: Some(sentence.into()), ..self }
    }

    /// The same with lines of numbers.
    pub fn with_numbers(self, numbers: impl Into<String>) -> Self {
        Self { numbers: numbers.into(), ..self }
    }

    /// The same with what went in, digit for digit, so that a small case can be worked through
    /// by hand.
    pub fn given(self, inputs: &[(&str, &dyn Debug)]) -> Self {
        let mut numbers = self.numbers.trim_end().to_owned();
        numbers += "\n\ngiven:\n";
        for (name, value) in inputs {
            let _ = writeln!(numbers, "  {name}: {value:?}");
        }
        self.with_numbers(numbers.trim_start())
    }

    /// The same with a picture, if expected and obtained can be told apart in it, and few enough points came
    /// back to be drawn.
    pub fn with_picture(self, picture: Picture) -> Self {
        const MOST: usize = 2_000;
        let few = picture.obtained.ends().nth(MOST).is_none();
        let picture = (few && picture.shows_a_difference()).then(|| Box::new(picture));
        Self { picture, ..self }
    }

    /// The same, or that it waits for an earlier function, when that fails as well and nothing
    /// better is known. Of several functions the first that is asked about is named.
    pub fn unless(self, function: &str, earlier: impl FnOnce() -> Result<(), Self>) -> Self {
        if self.misconception.is_some() || self.waits || earlier().is_ok() {
            return self;
        }
        let first = |sentence: &String| {
            format!(
                "This waits for `{function}`, which is not right yet: see to it first. {sentence}"
            )
        };
        let quiet = self.quiet.as_ref().map(first);
        Self { sentence: first(&self.sentence), quiet, waits: true, ..self }
    }
}

/// Tries all cases and gives the first failure whose misconception is known, or else the first.
///
/// # Errors
///
/// When a case fails.
pub fn each<'a, T: 'a>(
    cases: impl IntoIterator<Item = &'a T>,
    check: impl Fn(&T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut first = None;
    for failure in cases.into_iter().filter_map(|case| check(case).err()) {
        if failure.misconception.is_some() {
            return Err(failure);
        }
        first = first.or(Some(failure));
    }
    first.map_or(Ok(()), Err)
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        let failure = Self::new(fault.to_string());
        match fault {
            Fault::NotWritten(_) => failure.or_quietly("not written yet"),
            Fault::Panicked { .. } => failure.or_quietly("the answer panicked"),
            Fault::Output(_) => failure.or_quietly("the output cannot be read"),
            Fault::Stopped(_) => failure,
        }
    }
}

impl Display for Failure {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.sentence)?;
        if !self.numbers.is_empty() {
            write!(formatter, "\n\n{}", self.numbers.trim_end())?;
        }
        Ok(())
    }
}

/// An output beside what an oracle says.
pub struct Comparison<'a> {
    what: &'a str,
    obtained: DMatrix<f64>,
    expected: DMatrix<f64>,
    tolerance: f64,
    rows: &'a [&'a str],
    columns: &'a [&'a str],
    candidates: Vec<(&'static Misconception, DMatrix<f64>)>,
}

/// Compares numbers with those of an oracle. `what` names them in a sentence: "the Jacobian".
pub fn compare<'a, R, C, S, R2, C2, S2>(
    what: &'a str,
    obtained: &Matrix<f64, R, C, S>,
    expected: &Matrix<f64, R2, C2, S2>,
) -> Comparison<'a>
where
    R: Dim,
    C: Dim,
    S: RawStorage<f64, R, C>,
    R2: Dim,
    C2: Dim,
    S2: RawStorage<f64, R2, C2>,
{
    let (obtained, expected) = (dense(obtained), dense(expected));
    let candidates = Vec::new();
    Comparison { what, obtained, expected, tolerance: 1e-9, rows: &[], columns: &[], candidates }
}

/// Compares one number with that of an oracle.
pub fn compare_number(what: &str, obtained: f64, expected: f64) -> Comparison<'_> {
    compare_list(what, &[obtained], &[expected])
}

/// Compares a list of numbers with that of an oracle.
pub fn compare_list<'a>(what: &'a str, obtained: &[f64], expected: &[f64]) -> Comparison<'a> {
    compare(what, &column(obtained), &column(expected))
}

fn column(list: &[f64]) -> DMatrix<f64> {
    DMatrix::from_column_slice(list.len(), 1, list)
}

fn dense<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(matrix: &Matrix<f64, R, C, S>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)])
}

impl<'a> Comparison<'a> {
    /// How far entries may be off, as a part of the greatest entry expected. At first 1e-9.
    pub fn within(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// Names of rows and columns.
    pub fn labelled(self, rows: &'a [&'a str], columns: &'a [&'a str]) -> Self {
        Self { rows, columns, ..self }
    }

    /// What a misconception would give. It is named when the output agrees with it and not with
    /// the oracle.
    pub fn or<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
        mut self,
        misconception: &'static Misconception,
        candidate: &Matrix<f64, R, C, S>,
    ) -> Self {
        self.candidates.push((misconception, dense(candidate)));
        self
    }

    /// [`Comparison::or`] for one number.
    pub fn or_number(self, misconception: &'static Misconception, candidate: f64) -> Self {
        self.or_list(misconception, &[candidate])
    }

    /// [`Comparison::or`] for a list.
    pub fn or_list(self, misconception: &'static Misconception, candidate: &[f64]) -> Self {
        self.or(misconception, &DMatrix::from_column_slice(candidate.len(), 1, candidate))
    }

    /// Whether the output agrees with the oracle.
    ///
    /// # Errors
    ///
    /// A [`Failure`] with the numbers when it does not.
    pub fn judge(&self) -> Result<(), Failure> {
        let verdict = self.verdict();
        WATCHED.with_borrow_mut(|watched| match watched {
            Some(watched) => {
                watched.push(self.seen(verdict.err()));
                Ok(())
            }
            None => verdict,
        })
    }

    fn seen(&self, failure: Option<Failure>) -> Compared {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        Compared {
            what: self.what.to_owned(),
            obtained: self.obtained.clone(),
            expected: self.expected.clone(),
            tolerance: self.tolerance,
            rows: owned(self.rows),
            columns: owned(self.columns),
            failure,
        }
    }

    fn verdict(&self) -> Result<(), Failure> {
        let (obtained, expected) = (&self.obtained, &self.expected);
        if obtained.shape() != expected.shape() {
            let (rows, columns) = obtained.shape();
            let sentence = format!(
                "{}: {rows}×{columns} numbers came back, and there should be {}×{}.",
                self.what,
                expected.nrows(),
                expected.ncols()
            );
            let quiet =
                format!("{}: there should be more numbers, fewer, or in another shape.", self.what);
            return Err(Failure::new(sentence).or_quietly(quiet));
        }
        if let Some(bad) = obtained.iter().find(|entry| !entry.is_finite()) {
            let sentence = format!("{}: an entry is {bad}; every entry must be finite.", self.what);
            let quiet = format!("{}: every entry must be finite.", self.what);
            return Err(Failure::new(sentence).or_quietly(quiet).with_numbers(self.numbers()));
        }
        if agree(obtained, expected, self.tolerance) {
            return Ok(());
        }
        let known = self.candidates.iter().find(|(_, candidate)| {
            candidate.shape() == obtained.shape() && agree(obtained, candidate, self.tolerance)
        });
        let failure = match known {
            Some((misconception, _)) => Failure::known(misconception),
            None => Failure::new(format!("{} is not what it should be.", capital(self.what))),
        };
        Err(failure.with_numbers(self.numbers()))
    }

    /// Whether two entries are as near as they must be.
    fn near(&self, row: usize, column: usize) -> bool {
        near(&self.obtained, &self.expected, self.tolerance, (row, column))
    }

    /// Both matrices as a table; wrong entries are marked. Long ones are cut to their first rows
    /// that are wrong.
    fn numbers(&self) -> String {
        const MOST: usize = 12;
        let mut text = String::new();
        let wrong = |row: &usize| (0..self.expected.ncols()).any(|c| !self.near(*row, c));
        let all: Vec<usize> = match self.expected.nrows() {
            count if count <= MOST => (0..count).collect(),
            count => (0..count).filter(wrong).collect(),
        };
        for (title, is_obtained) in [("expected", false), ("obtained", true)] {
            let _ = writeln!(text, "{title}:");
            self.heading(&mut text);
            for &row in all.iter().take(MOST) {
                let _ = write!(text, "{:>10}", self.label(self.rows, row));
                for column in 0..self.expected.ncols() {
                    let at = (row, column);
                    let marked = !self.near(row, column);
                    let [expected, obtained] = if marked {
                        told_apart(self.expected[at], self.obtained[at])
                    } else {
                        [self.expected[at], self.obtained[at]].map(readable)
                    };
                    let number = if is_obtained { obtained } else { expected };
                    let mark = if is_obtained && marked { '*' } else { ' ' };
                    let _ = write!(text, "{number:>12}{mark}");
                }
                text.push('\n');
            }
        }
        if all.len() > MOST {
            let _ = writeln!(text, "and {} more rows that differ", all.len() - MOST);
        }
        let whole = if self.expected.len() == 1 { "it" } else { "the greatest entry" };
        let _ = writeln!(text, "* differs by more than {:.0e} of {whole}", self.tolerance);
        text
    }

    fn heading(&self, text: &mut String) {
        if !self.columns.is_empty() {
            let _ = write!(text, "{:10}", "");
            for column in self.columns {
                let _ = write!(text, "{column:>12} ");
            }
            text.push('\n');
        }
    }

    fn label(&self, labels: &[&str], index: usize) -> String {
        labels.get(index).map_or_else(|| format!("[{index}]"), |label| (*label).to_owned())
    }
}

/// Whether an entry of two matrices is as near as it must be, to a part of the greatest of the second.
fn near(a: &DMatrix<f64>, b: &DMatrix<f64>, tolerance: f64, at: (usize, usize)) -> bool {
    (a[at] - b[at]).abs() <= tolerance * b.amax() + f64::MIN_POSITIVE
}

impl Compared {
    /// Whether an entry is not what it should be. Both matrices have one there.
    pub fn differs(&self, row: usize, column: usize) -> bool {
        !near(&self.obtained, &self.expected, self.tolerance, (row, column))
    }
}

/// Whether all entries agree, to a part of the greatest of the second.
fn agree(a: &DMatrix<f64>, b: &DMatrix<f64>, tolerance: f64) -> bool {
    let scale = b.amax();
    a.iter().zip(b.iter()).all(|(a, b)| (a - b).abs() <= tolerance * scale + f64::MIN_POSITIVE)
}

/// A number in a form that can be read: five digits, with an exponent where it is needed.
pub fn readable(number: f64) -> String {
    with_digits(number, 5)
}

/// Two numbers that differ, with as many digits as it takes to see it, and five at least.
pub fn told_apart(a: f64, b: f64) -> [String; 2] {
    let written = (5..=16).map(|digits| [a, b].map(|number| with_digits(number, digits)));
    let differs = |pair: &[String; 2]| pair[0] != pair[1];
    written.clone().find(differs).unwrap_or_else(|| [a, b].map(readable))
}

fn with_digits(number: f64, digits: i32) -> String {
    let size = number.abs();
    match size {
        _ if !number.is_finite() => number.to_string(),
        0.0 => "0".to_owned(),
        _ if (1e-3..1e5).contains(&size) => {
            let decimals = (digits - 1 - size.log10().floor() as i32).clamp(0, digits + 1) as usize;
            format!("{number:.decimals$}")
        }
        _ => format!("{number:.*e}", (digits - 2) as usize),
    }
}

fn capital(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
