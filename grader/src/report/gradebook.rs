//! The gradebook: a CSV file with a line for each submission.

use std::io::Write;

use super::{NAME, decimals};
use crate::grade::{Grade, Outcome};
use crate::text::harmless_line;
use exercise_spec::Exercise;

/// Writes a gradebook line by line.
pub struct Gradebook<W: Write> {
    writer: csv::Writer<W>,
    exercises: Vec<&'static str>,
}

impl<W: Write> Gradebook<W> {
    /// Begins one with a column for each exercise.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn new(to: W, exercises: &[&'static Exercise]) -> csv::Result<Self> {
        let mut writer = csv::Writer::from_writer(to);
        let exercises: Vec<&str> = exercises.iter().map(|exercise| exercise.slug).collect();
        let before = ["submission", "student", "points", "of"];
        writer.write_record(before.iter().chain(&exercises).chain(&["status"]))?;
        Ok(Self { writer, exercises })
    }

    /// The line of a grade. What could not be graded is an empty cell and never a zero, and so is
    /// the sum it belongs to.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn add(&mut self, grade: &Grade) -> csv::Result<()> {
        let number = |number: Option<f64>| number.map_or_else(String::new, |n| decimals(n, 4));
        let mut row = vec![
            cell(&grade.submission),
            cell(grade.student.as_deref().unwrap_or_default()),
            number(grade.earned()),
            number(Some(grade.points())),
        ];
        for slug in &self.exercises {
            let exercise = grade.exercises.iter().find(|exercise| exercise.exercise == *slug);
            row.push(number(exercise.and_then(|exercise| exercise.earned())));
        }
        row.push(status(grade));
        self.writer.write_record(row)
    }

    /// The line of somebody on the roster who handed in nothing. What that is worth is for the
    /// course to say, and the cells stay empty.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn add_absent(&mut self, folder: &str, student: &str) -> csv::Result<()> {
        let mut row = vec![cell(folder), cell(student)];
        row.resize(4 + self.exercises.len(), String::new());
        row.push("nothing handed in".to_owned());
        self.writer.write_record(row)
    }

    /// Ends it.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn finish(mut self) -> std::io::Result<()> {
        self.writer.flush()
    }
}

fn status(grade: &Grade) -> String {
    let ungraded: Vec<&str> = grade.ungraded().map(|exercise| &*exercise.exercise).collect();
    if !ungraded.is_empty() {
        return cell(&format!("could not be graded: {}", ungraded.join(" ")));
    }
    let handed_in = |outcome: &Outcome| *outcome != Outcome::Missing;
    if grade.exercises.iter().any(|exercise| handed_in(&exercise.outcome)) {
        "graded".to_owned()
    } else {
        "graded: no answer in it".to_owned()
    }
}

/// Text that no spreadsheet takes for a formula.
fn cell(text: &str) -> String {
    let text = harmless_line(text, NAME);
    let first = text.trim_start().chars().next();
    match first {
        Some('=' | '+' | '-' | '@' | '|' | '%' | '＝' | '＋' | '－' | '＠') => {
            format!("'{text}")
        }
        _ => text,
    }
}
