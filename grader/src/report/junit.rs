//! JUnit XML of a submission, of the part of it that GitLab and the actions of GitHub read: a test
//! case has a class and a name, which together occur once, and a failure is told by its text.

use std::io::{self, Write};

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::{Detail, MARKED_INSTEAD, Told, passed, points, why_not, words};
use crate::grade::{CheckGrade, ExerciseGrade, Grade, Outcome, Verdict};
use crate::text::{harmless, harmless_line};

/// The file of one submission.
///
/// # Errors
///
/// When it cannot be written as XML.
pub fn xml(grade: &Grade, detail: Detail) -> Result<String, String> {
    written(grade, detail, true)
}

/// The file of a batch, written suite by suite. It leaves numbers out, because GitLab reads no
/// more than 30 megabytes.
#[derive(Debug)]
pub struct Suites<W: Write>(W);

impl<W: Write> Suites<W> {
    /// Begins one.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn new(mut to: W) -> io::Result<Self> {
        writeln!(to, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        writeln!(to, "<testsuites name=\"{RUN}\">")?;
        Ok(Self(to))
    }

    /// Adds the suite of a submission.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn add(&mut self, grade: &Grade, detail: Detail) -> io::Result<()> {
        let file = written(grade, detail, false).map_err(io::Error::other)?;
        const END: &str = "</testsuite>";
        // Text is escaped: what looks like a tag is one.
        let suite = file.find("<testsuite ").zip(file.rfind(END));
        let suite = suite.and_then(|(begin, end)| file.get(begin..end + END.len()));
        writeln!(self.0, "    {}", suite.unwrap_or_default())
    }

    /// Ends it.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        writeln!(self.0, "</testsuites>")?;
        self.0.flush()
    }
}

const RUN: &str = "cargo grade";

fn written(grade: &Grade, detail: Detail, numbers: bool) -> Result<String, String> {
    let submission = harmless_line(&grade.submission, super::NAME);
    let mut suite = TestSuite::new(&*submission);
    for exercise in &grade.exercises {
        let class = format!("{submission}.{}", exercise.exercise);
        for mut case in cases(exercise, detail, numbers) {
            case.set_classname(&*class);
            suite.add_test_case(case);
        }
    }
    let notices = grade.notices.iter().take(20);
    let notices: Vec<String> = notices.map(|notice| harmless(notice, super::SENTENCE)).collect();
    if !notices.is_empty() {
        suite.set_system_out(notices.join("\n"));
    }
    let mut report = Report::new(RUN);
    report.add_test_suite(suite);
    report.to_string().map_err(|error| format!("no JUnit report of {submission}: {error}"))
}

fn cases(exercise: &ExerciseGrade, detail: Detail, numbers: bool) -> Vec<TestCase> {
    if let Some(mut told) = Told::of_exercise(exercise) {
        if !numbers {
            told.page.clear();
        }
        let (kind, what) = match &exercise.outcome {
            Outcome::Missing => (NonSuccessKind::Failure, "missing"),
            Outcome::NotBegun => (NonSuccessKind::Failure, "not begun"),
            Outcome::Refused(_) => (NonSuccessKind::Failure, "refused"),
            Outcome::DoesNotCompile(_) => (NonSuccessKind::Failure, "does not compile"),
            Outcome::Ran | Outcome::CouldNotGrade(_) | Outcome::InWords => {
                return vec![ungraded("the answer runs", exercise)];
            }
        };
        return vec![TestCase::new("the answer runs", status(kind, what, &told))];
    }
    let case = |check: &CheckGrade| {
        let mut told = detail.of_check(exercise, check);
        if !numbers {
            told.page.clear();
        }
        case(exercise, check, told)
    };
    exercise.checks.iter().map(case).collect()
}

fn case(exercise: &ExerciseGrade, check: &CheckGrade, mut told: Told) -> TestCase {
    // A public check and a hidden one may have the same name.
    let name =
        if check.hidden { format!("hidden: {}", words(&check.name)) } else { words(&check.name) };
    match check.verdict {
        Verdict::Passed => TestCase::new(name, TestCaseStatus::success()),
        Verdict::CouldNotGrade => ungraded(&name, exercise),
        Verdict::Failed => {
            // GitLab wants a text, whatever students may be told.
            if told.text().is_empty() {
                let (passed, all) = passed(exercise, true);
                told.sentence = format!("{passed} of {all} hidden checks pass.");
            }
            TestCase::new(name, status(NonSuccessKind::Failure, "wrong", &told))
        }
    }
}

/// An error and not a failure: it says nothing about the answer. Where a person has given points, it is skipped.
fn ungraded(name: &str, exercise: &ExerciseGrade) -> TestCase {
    if let Some(marked) = exercise.marked {
        let mut status = TestCaseStatus::skipped();
        status.set_message(format!("{MARKED_INSTEAD} They are {}.", points(marked)));
        return TestCase::new(name, status);
    }
    let sentence = format!(
        "could not be graded, which is no zero: {} ({} points are open)",
        why_not(exercise),
        points(exercise.of())
    );
    let told = Told { sentence, page: String::new() };
    TestCase::new(name, status(NonSuccessKind::Error, "could not grade", &told))
}

fn status(kind: NonSuccessKind, what: &str, told: &Told) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(what);
    status.set_message(told.sentence.replace('\n', " "));
    // GitLab shows this text and not the message.
    status.set_description(told.text());
    status
}
