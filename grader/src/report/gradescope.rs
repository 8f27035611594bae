//! The `results.json` that Gradescope shows a student.

use serde::Serialize;

use super::{COULD_NOT_GRADE, Detail, NAME, SENTENCE, Told, points, words};
use crate::grade::{CheckGrade, ExerciseGrade, Grade, Verdict};
use crate::text::{harmless, harmless_line};

/// The file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Missing when something could not be graded. Gradescope would add up what is there, and the
    /// part that is missing would be a zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    score: Option<f64>,
    output: String,
    // Without these Gradescope reads HTML in the first of them.
    output_format: &'static str,
    test_output_format: &'static str,
    test_name_format: &'static str,
    tests: Vec<Test>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Test {
    #[serde(skip_serializing_if = "Option::is_none")]
    score: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_score: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    status: Option<&'static str>,
    name: String,
    number: String,
    output: String,
}

/// What Gradescope is to show of a submission.
pub fn results(grade: &Grade, detail: Detail) -> Results {
    let earned = grade.earned();
    let mut tests: Vec<Test> = Vec::new();
    for (index, exercise) in grade.exercises.iter().enumerate() {
        tests.extend(tests_of(exercise, index + 1, detail));
    }
    if earned.is_none() {
        for test in &mut tests {
            test.score = None;
            test.max_score = None;
        }
    }
    Results {
        score: earned,
        output: output(grade),
        output_format: "text",
        test_output_format: "text",
        test_name_format: "text",
        tests,
    }
}

/// The file's text.
pub fn json(grade: &Grade, detail: Detail) -> String {
    serde_json::to_string_pretty(&results(grade, detail)).unwrap_or_default()
}

fn output(grade: &Grade) -> String {
    let mut lines = Vec::new();
    if grade.earned().is_none() {
        let names: Vec<String> =
            grade.ungraded().map(|exercise| harmless_line(&exercise.title, NAME)).collect();
        lines.push(format!("{COULD_NOT_GRADE}\nIt concerns: {}.", names.join(", ")));
        for exercise in &grade.exercises {
            let title = harmless_line(&exercise.title, NAME);
            lines.extend(exercise.earned().map(|earned| {
                format!("{title}: {} of {} points", points(earned), points(exercise.of()))
            }));
        }
    }
    lines.extend(grade.notices.iter().take(20).map(|notice| harmless(notice, SENTENCE)));
    lines.join("\n")
}

fn tests_of(exercise: &ExerciseGrade, number: usize, detail: Detail) -> Vec<Test> {
    let title = harmless_line(&exercise.title, NAME);
    let mut tests = match Told::of_exercise(exercise) {
        Some(told) => vec![never_ran(exercise, &title, number, &told)],
        None => of_checks(exercise, &title, number, detail),
    };
    tests.extend(by_person(exercise, &title, number));
    tests
}

/// An answer that never ran. Points that a person gave it stand with what that person says.
fn never_ran(exercise: &ExerciseGrade, title: &str, number: usize, told: &Told) -> Test {
    let score = exercise.program().filter(|_| exercise.marked.is_none());
    Test {
        score,
        max_score: score.map(|_| exercise.points),
        status: score.map(|_| "failed"),
        name: title.to_owned(),
        number: number.to_string(),
        output: told.text(),
    }
}

fn of_checks(exercise: &ExerciseGrade, title: &str, number: usize, detail: Detail) -> Vec<Test> {
    let all: f64 = exercise.checks.iter().map(|check| check.weight).sum();
    let share = |check: &CheckGrade| {
        if all > 0.0 { exercise.points * check.weight / all } else { 0.0 }
    };
    let test = |(index, check): (usize, &CheckGrade)| {
        let hidden = if check.hidden { " (hidden)" } else { "" };
        let (score, status) = match check.verdict {
            // Its points are those of a person.
            Verdict::Passed if exercise.marked.is_some() => (None, Some("passed")),
            Verdict::Failed if exercise.marked.is_some() => (None, Some("failed")),
            Verdict::Passed => (Some(share(check)), Some("passed")),
            Verdict::Failed => (Some(0.0), Some("failed")),
            Verdict::CouldNotGrade => (None, None),
        };
        Test {
            score,
            max_score: score.map(|_| share(check)),
            status,
            name: format!("{title}: {}{hidden}", words(&check.name)),
            number: format!("{number}.{}", index + 1),
            output: detail.of_check(exercise, check).text(),
        }
    };
    exercise.checks.iter().enumerate().map(test).collect()
}

/// What a person gave, and what a person says.
fn by_person(exercise: &ExerciseGrade, title: &str, number: usize) -> Vec<Test> {
    let comments = harmless(&exercise.comments.join("\n"), SENTENCE);
    let test = |what: &str, points: Option<(f64, f64)>, place: usize, output: String| Test {
        score: points.map(|(earned, _)| earned),
        max_score: points.map(|(_, of)| of),
        status: None,
        name: format!("{title}: {what}"),
        number: format!("{number}.{}", exercise.checks.len() + place),
        output,
    };
    let marked = exercise.marked.map(|earned| (earned, exercise.points));
    let words = exercise.words.map(|words| (words.earned, words.of));
    let mut tests = Vec::new();
    if marked.is_some() || !comments.is_empty() {
        tests.push(test("your instructor", marked, 1, comments));
    }
    tests.extend(words.map(|words| test("in words", Some(words), 2, String::new())));
    tests
}
