//! What came out, for a terminal, a gradebook, a machine and a student.
//!
//! Every report is made of grades one at a time, so that a batch of any size needs no memory. What
//! came from a submission is cut and escaped in each for what would read it.

pub mod gradebook;
pub mod gradescope;
pub mod junit;
pub mod markdown;
pub mod terminal;

use crate::grade::{CheckGrade, ExerciseGrade, Grade, Outcome, Verdict};
use crate::text::{harmless, harmless_line};

/// What students are told about hidden checks. Public ones they have, and are told in full.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Sentences and numbers.
    Full,
    /// Sentences alone, without words and long numbers that came from the answer.
    Hint,
    /// Whether it passed.
    None,
}

/// What a student reads where the grader failed, or where an archive cannot be unpacked.
pub const COULD_NOT_GRADE: &str = "This could not be graded, and it is no zero. Your instructor \
                                   will look at it.";

/// The same where a person has given points instead.
pub const MARKED_INSTEAD: &str =
    "This could not be graded by the program, and the points are those that your instructor gave.";

/// How the machine begins to say why it stopped an answer.
const STOPPED: &str = "the call was stopped: ";
/// As long as a sentence may be.
const SENTENCE: usize = 1_200;
/// As long as numbers or what a compiler says may be.
const PAGE: usize = 6_000;
/// As long as a name may be.
const NAME: usize = 80;

/// What a report says of one check or of an answer that never ran.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Told {
    /// In words; empty when there is nothing to say.
    pub sentence: String,
    /// Numbers or what the compiler says; may be empty.
    pub page: String,
}

impl Detail {
    /// What a student is told of a check.
    pub fn of_check(self, exercise: &ExerciseGrade, check: &CheckGrade) -> Told {
        let all = || Told::new(&check.sentence, &check.numbers);
        match (check.verdict, self) {
            (Verdict::Passed, _) => Told::new("", ""),
            (Verdict::CouldNotGrade, _) if exercise.marked.is_some() => {
                Told::new(MARKED_INSTEAD, "")
            }
            (Verdict::CouldNotGrade, _) => Told::new(COULD_NOT_GRADE, ""),
            (Verdict::Failed, _) if !check.hidden => all(),
            (Verdict::Failed, Self::Full) => all(),
            // What an answer says of a hidden check may be the instance itself.
            (Verdict::Failed, Self::Hint) => {
                let sentence = check.quiet.as_ref().unwrap_or(&check.sentence);
                // What the machine says and the words for a known mistake are the same for all.
                let known = check.misconception.is_some() || sentence.starts_with(STOPPED);
                Told::new(&if known { sentence.clone() } else { without_numbers(sentence) }, "")
            }
            (Verdict::Failed, Self::None) => Told::new("", ""),
        }
    }

    /// The picture of a check that a student is shown.
    pub fn picture(self, check: &CheckGrade) -> Option<&str> {
        let shown = !check.hidden || self == Self::Full;
        check.picture.as_deref().filter(|_| shown && check.verdict == Verdict::Failed)
    }
}

/// The file of a check's picture, beside the feedback.
pub fn picture_file(exercise: &ExerciseGrade, check: &CheckGrade) -> String {
    let name = format!("{}-{}", exercise.exercise, check.name);
    name.replace(|letter: char| !letter.is_ascii_alphanumeric() && letter != '-', "_") + ".svg"
}

impl Told {
    fn new(sentence: &str, page: &str) -> Self {
        let sentence = capital(&harmless(sentence.trim(), SENTENCE));
        Self { sentence, page: harmless(page.trim_end(), PAGE) }
    }

    /// What a student is told of an answer that never ran. Nothing when it did. What it earns is told elsewhere when a
    /// person has said it.
    pub fn of_exercise(exercise: &ExerciseGrade) -> Option<Self> {
        let marked = exercise.marked.is_some();
        let earns = if marked { "" } else { ", so it earns nothing" };
        let (sentence, page) = match &exercise.outcome {
            Outcome::Ran | Outcome::InWords => return None,
            Outcome::Missing => (format!("There is no such file{earns}."), ""),
            Outcome::NotBegun => (format!("The file is as it was handed out{earns}."), ""),
            Outcome::Refused(why) => {
                (format!("The file is refused{earns}. What has to go:"), why.as_str())
            }
            Outcome::DoesNotCompile(why) => {
                (format!("It does not compile{earns}. What the compiler says:"), why.as_str())
            }
            Outcome::CouldNotGrade(_) if marked => ("No check could grade it.".to_owned(), ""),
            Outcome::CouldNotGrade(_) => (COULD_NOT_GRADE.to_owned(), ""),
        };
        Some(Self::new(&sentence, page))
    }

    /// Both in one text.
    pub fn text(&self) -> String {
        match (self.sentence.is_empty(), self.page.is_empty()) {
            (_, true) => self.sentence.clone(),
            (true, false) => self.page.clone(),
            (false, false) => format!("{}\n\n{}", self.sentence, self.page),
        }
    }
}

/// A sentence without its numbers: an answer may have returned them, or chosen how many it returned.
/// Digits in a name stay.
fn without_numbers(sentence: &str) -> String {
    let mut shown = String::new();
    let mut before = ' ';
    let mut letters = sentence.chars().peekable();
    while let Some(letter) = letters.next() {
        if !letter.is_ascii_digit() || before.is_alphanumeric() || before == '_' {
            shown.push(letter);
            before = letter;
            continue;
        }
        let goes_on = |next: &char| next.is_ascii_alphanumeric() || *next == '.';
        let mut last = letter;
        while let Some(next) = letters.next_if(goes_on) {
            last = next;
        }
        shown.push('…');
        // A number does not end in the point that ends a sentence.
        if last == '.' {
            shown.push('.');
        }
        before = ' ';
    }
    shown
}

fn capital(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A number of points, rounded to three decimals and without the zeros at its end. Halves go away
/// from zero.
pub fn points(number: f64) -> String {
    let text = format!("{:.3}", (number * 1e3).round() / 1e3);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The name of a check or a misconception as words.
pub fn words(name: &str) -> String {
    harmless_line(name, NAME).replace('_', " ")
}

/// Who handed it in, or the name of the folder where nobody said.
pub fn who(grade: &Grade) -> String {
    harmless_line(grade.student.as_deref().unwrap_or(&grade.submission), NAME)
}

/// How many checks passed and how many there are: public ones, or hidden ones.
pub fn passed(exercise: &ExerciseGrade, hidden: bool) -> (usize, usize) {
    let checks = exercise.checks.iter().filter(|check| check.hidden == hidden);
    let passed = checks.clone().filter(|check| check.verdict == Verdict::Passed).count();
    (passed, checks.count())
}

/// An exercise in a table: its points, or a mark for why there are none.
pub fn mark(exercise: &ExerciseGrade) -> String {
    match (&exercise.outcome, exercise.earned()) {
        (_, None) => "?".to_owned(),
        (Outcome::Missing, _) => "-".to_owned(),
        (Outcome::NotBegun, _) => "n".to_owned(),
        (Outcome::Refused(_), _) => "r".to_owned(),
        (Outcome::DoesNotCompile(_), _) => "c".to_owned(),
        (_, Some(earned)) => points(earned),
    }
}

/// What became of an exercise, in a word or two.
pub fn state(exercise: &ExerciseGrade) -> &'static str {
    match (&exercise.outcome, exercise.earned()) {
        (_, None) => "could not be graded",
        (Outcome::Missing, _) => "no file",
        (Outcome::NotBegun, _) => "not begun",
        (Outcome::Refused(_), _) => "refused",
        (Outcome::DoesNotCompile(_), _) => "does not compile",
        (Outcome::Ran | Outcome::CouldNotGrade(_) | Outcome::InWords, _) => "graded",
    }
}

/// What the marks mean.
pub const MARKS: &str = "A dash is no file, n is the skeleton as it was, c does not compile, r was \
                         refused: these earn 0. A question mark could not be graded, which is no \
                         0: a person must look.";

/// Why a submission could not be graded: each reason once, with the exercises that it holds for,
/// or with none when it holds for all.
pub fn reasons(grade: &Grade) -> Vec<(String, Vec<&str>)> {
    let mut reasons: Vec<(String, Vec<&str>)> = Vec::new();
    for exercise in grade.ungraded() {
        let why = why_not(exercise);
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, exercises)) => exercises.push(&exercise.exercise),
            None => reasons.push((why, vec![&exercise.exercise])),
        }
    }
    for (_, exercises) in &mut reasons {
        if exercises.len() == grade.programs().count() {
            exercises.clear();
        }
    }
    reasons
}

/// Why an exercise could not be graded, for whoever runs the grader.
pub fn why_not(exercise: &ExerciseGrade) -> String {
    let why = match &exercise.outcome {
        Outcome::CouldNotGrade(why) => why.as_str(),
        _ => {
            let ungraded = |check: &&CheckGrade| check.verdict == Verdict::CouldNotGrade;
            exercise.checks.iter().find(ungraded).map_or("", |check| check.sentence.as_str())
        }
    };
    let why = harmless(why.trim(), SENTENCE);
    if why.is_empty() { "no reason is known".to_owned() } else { why }
}
