//! What a regrade changed.

use std::fmt::Write as _;

use crate::grade::{ExerciseGrade, Grade, Outcome, Verdict};
use crate::report::markdown::{counted, escaped};
use crate::report::terminal::wrapped;
use crate::report::{points, who, words};

/// As many lines as the terminal shows.
const LINES: usize = 20;

/// The differences between a finished batch and the one that grades it again, gathered grade by
/// grade.
#[derive(Debug, Default)]
pub struct Changes {
    same: usize,
    changed: Vec<Change>,
    added: Vec<String>,
    gone: Vec<String>,
}

#[derive(Debug)]
struct Change {
    who: String,
    before: Option<f64>,
    now: Option<f64>,
    /// Exercises, and what became of each.
    exercises: Vec<(String, String)>,
}

impl Changes {
    /// Compares the grade of a submission with the one it had.
    pub fn add(&mut self, former: Option<&Grade>, grade: &Grade) {
        let Some(former) = former else {
            self.added.push(who(grade));
            return;
        };
        let of = |exercise: &ExerciseGrade| {
            former.exercises.iter().find(|before| before.exercise == exercise.exercise)
        };
        let changed = |exercise: &ExerciseGrade| {
            Some((exercise.exercise.clone(), difference(of(exercise), exercise)?))
        };
        let mut exercises: Vec<(String, String)> =
            grade.exercises.iter().filter_map(changed).collect();
        for before in &former.exercises {
            if !grade.exercises.iter().any(|exercise| exercise.exercise == before.exercise) {
                exercises.push((before.exercise.clone(), "not graded this time".to_owned()));
            }
        }
        if exercises.is_empty() {
            self.same += 1;
            return;
        }
        let (before, now) = (former.earned(), grade.earned());
        self.changed.push(Change { who: who(grade), before, now, exercises });
    }

    /// Adds a submission that has a former grade and is no part of this batch.
    pub fn add_gone(&mut self, submission: &str) {
        self.gone.push(submission.to_owned());
    }

    /// The report.
    pub fn markdown(&self, former: &str, now: &str) -> String {
        let mut text = format!("# What changed\n\n{}\n", self.counts());
        if former != now {
            let _ = write!(
                text,
                "\nThe hidden instances were {former} and are {now}: they are others.\n"
            );
        }
        if !self.changed.is_empty() {
            text += "\n| Submission | Before | Now | |\n| --- | --: | --: | --- |\n";
        }
        for change in &self.changed {
            let exercises = change.exercises.iter();
            let exercises: Vec<String> =
                exercises.map(|(slug, what)| format!("`{slug}`: {}", escaped(what, 600))).collect();
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} |",
                escaped(&change.who, 80),
                shown(change.before),
                shown(change.now),
                exercises.join("<br>")
            );
        }
        for (title, names) in
            [("Not in the former batch", &self.added), ("In the former batch alone", &self.gone)]
        {
            if !names.is_empty() {
                let _ = write!(text, "\n## {title}\n\n");
            }
            for name in names {
                let _ = writeln!(text, "- {}", escaped(name, 80));
            }
        }
        text
    }

    /// What the terminal shows.
    pub fn terminal(&self) -> String {
        let mut text = format!("\n{}", wrapped(&self.counts(), ""));
        for change in self.changed.iter().take(LINES) {
            let exercises: Vec<&str> =
                change.exercises.iter().map(|(slug, _)| slug.as_str()).collect();
            let (before, now) = (shown(change.before), shown(change.now));
            let line = format!("{}: {before} → {now} ({})", change.who, exercises.join(", "));
            text += &wrapped(&line, "  ");
        }
        if self.changed.len() > LINES {
            let _ = writeln!(text, "  and {} more, in changes.md", self.changed.len() - LINES);
        }
        text
    }

    fn counts(&self) -> String {
        let mut text = format!(
            "Graded again: {} as before, {} otherwise.",
            counted(self.same, "grade"),
            self.changed.len()
        );
        if !self.added.is_empty() {
            let _ = write!(text, " {} new.", self.added.len());
        }
        if !self.gone.is_empty() {
            let _ = write!(
                text,
                " {} of the former batch are no part of this one; their folders stay.",
                self.gone.len()
            );
        }
        text
    }
}

fn shown(earned: Option<f64>) -> String {
    earned.map_or_else(|| "?".to_owned(), points)
}

/// How an exercise differs from before, if it does.
fn difference(former: Option<&ExerciseGrade>, exercise: &ExerciseGrade) -> Option<String> {
    let Some(former) = former else {
        return Some("not graded before".to_owned());
    };
    let (before, now) = (former.earned(), exercise.earned());
    let state = |exercise: &ExerciseGrade| std::mem::discriminant(&exercise.outcome);
    let flipped = flipped(former, exercise);
    if before == now && state(former) == state(exercise) && flipped.is_empty() {
        return None;
    }
    let mut text = format!("{} → {}", shown(before), shown(now));
    if state(former) != state(exercise) {
        let _ = write!(text, ", {} → {}", outcome(former), outcome(exercise));
    }
    if !flipped.is_empty() {
        let _ = write!(text, "; {}", flipped.join(", "));
    }
    Some(text)
}

fn outcome(exercise: &ExerciseGrade) -> &'static str {
    match exercise.outcome {
        Outcome::Ran => "ran",
        Outcome::Missing => "no file",
        Outcome::NotBegun => "not begun",
        Outcome::Refused(_) => "refused",
        Outcome::DoesNotCompile(_) => "does not compile",
        Outcome::CouldNotGrade(_) => "could not be graded",
        Outcome::InWords => "in words",
    }
}

/// Checks with another verdict than before.
fn flipped(former: &ExerciseGrade, exercise: &ExerciseGrade) -> Vec<String> {
    let of = |name: &str, hidden: bool| {
        former.checks.iter().find(|check| check.name == name && check.hidden == hidden)
    };
    let verdict = |verdict: Verdict| match verdict {
        Verdict::Passed => "passes",
        Verdict::Failed => "fails",
        Verdict::CouldNotGrade => "could not be graded",
    };
    let changed = exercise.checks.iter().filter(|check| {
        of(&check.name, check.hidden).is_some_and(|before| before.verdict != check.verdict)
    });
    changed.map(|check| format!("{} {}", words(&check.name), verdict(check.verdict))).collect()
}
