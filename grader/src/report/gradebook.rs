//! The gradebook: a CSV file with a line for each submission.

use std::io::Write;

use super::{points, state};
use crate::grade::{Grade, Outcome};
use crate::text::harmless_line;
use exercise_spec::Exercise;

/// Writes a gradebook line by line.
pub struct Gradebook<W: Write> {
    writer: csv::Writer<W>,
    exercises: Vec<&'static str>,
    /// Names of the columns that tell what became of each exercise.
    states: Vec<String>,
    /// Questions whose answers in words have points.
    words: Vec<&'static str>,
    /// How many columns of the roster are carried over.
    further: usize,
}

const BEFORE: [&str; 2] = ["submission", "student"];
const POINTS: [&str; 2] = ["points", "of"];
/// How late it came, what is left then, the folder as it was handed in, and what became of it.
const AFTER: [&str; 4] = ["days late", "points after lateness", "folder", "status"];

impl<W: Write> Gradebook<W> {
    /// Begins one with the further columns of the roster and a column for each exercise.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn new(
        to: W,
        exercises: &[&'static Exercise],
        words: &[&'static str],
        further: &[String],
    ) -> csv::Result<Self> {
        let mut writer = csv::Writer::from_writer(to);
        let exercises: Vec<&str> = exercises.iter().map(|exercise| exercise.slug).collect();
        let states: Vec<String> = exercises.iter().map(|slug| format!("{slug} status")).collect();
        let words_of: Vec<String> = words.iter().map(|slug| format!("{slug} words")).collect();
        let made = states.iter().chain(&words_of).map(String::as_str);
        let columns = POINTS.into_iter().chain(exercises.iter().copied()).chain(made).chain(AFTER);
        let ours: Vec<&str> = BEFORE.into_iter().chain(columns).collect();
        // No two columns have one name.
        let further = further.iter().map(|column| match ours.contains(&column.as_str()) {
            true => format!("roster {column}"),
            false => cell(column),
        });
        let (before, after) = ours.split_at(BEFORE.len());
        let mut heading: Vec<String> = before.iter().map(|name| (*name).to_owned()).collect();
        heading.extend(further);
        let further = heading.len() - before.len();
        heading.extend(after.iter().map(|name| (*name).to_owned()));
        writer.write_record(heading)?;
        Ok(Self { writer, exercises, states, words: words.to_vec(), further })
    }

    /// The line of a grade. What could not be graded is an empty cell and never a zero, and so is
    /// the sum it belongs to.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn add(&mut self, grade: &Grade, folder: &str, further: &[String]) -> csv::Result<()> {
        let number = |number: Option<f64>| number.map_or_else(String::new, points);
        let student = grade.student.as_deref().unwrap_or_default();
        let mut row = self.begun(&grade.submission, student, further);
        row.extend([number(grade.earned()), number(Some(grade.points()))]);
        for slug in &self.exercises {
            let exercise = grade.exercises.iter().find(|exercise| exercise.exercise == *slug);
            row.push(number(exercise.and_then(|exercise| exercise.earned())));
        }
        for slug in &self.exercises {
            let exercise = grade.exercises.iter().find(|exercise| exercise.exercise == *slug);
            row.push(exercise.map_or_else(String::new, |exercise| state(exercise).to_owned()));
        }
        for slug in &self.words {
            let exercise = grade.exercises.iter().find(|exercise| exercise.exercise == *slug);
            row.push(number(exercise.and_then(|exercise| Some(exercise.words?.earned))));
        }
        row.extend([number(grade.late.map(|late| late.days)), number(grade.after_lateness())]);
        row.extend([cell(folder), status(grade)]);
        self.writer.write_record(row)
    }

    /// The line of somebody on the roster who handed in nothing. What that is worth is for the
    /// course to say, and the cells stay empty.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn add_absent(
        &mut self,
        folder: &str,
        student: &str,
        further: &[String],
    ) -> csv::Result<()> {
        let mut row = self.begun(folder, student, further);
        let empty = POINTS.len() + self.exercises.len() + self.states.len() + self.words.len() + 2;
        row.resize(row.len() + empty, String::new());
        row.extend([cell(folder), "nothing handed in".to_owned()]);
        self.writer.write_record(row)
    }

    fn begun(&self, submission: &str, student: &str, further: &[String]) -> Vec<String> {
        let mut row = vec![cell(submission), cell(student)];
        row.extend(further.iter().take(self.further).map(|text| cell(text)));
        row.resize(BEFORE.len() + self.further, String::new());
        row
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
    if ungraded.len() == grade.programs().count() && !ungraded.is_empty() {
        return "could not be graded".to_owned();
    }
    if !ungraded.is_empty() {
        return cell(&format!("could not be graded: {}", ungraded.join(" ")));
    }
    let nothing = |outcome: &Outcome| matches!(outcome, Outcome::Missing | Outcome::NotBegun);
    let status = match grade.programs().all(|exercise| nothing(&exercise.outcome)) {
        _ if grade.is_empty() => "graded: no answer in it",
        true => "graded: no answer was begun",
        false => "graded",
    };
    status.to_owned()
}

/// As long as a cell may be: no shorter than what a roster or a file of marks may have in it.
const CELL: usize = 200;

/// Text that no spreadsheet takes for a formula, wherever it lets a cell begin: some end one at a
/// semicolon or a tab.
pub(crate) fn cell(text: &str) -> String {
    let mut shown = String::new();
    let mut begins = true;
    for letter in harmless_line(text.trim(), CELL).chars() {
        let sign = matches!(letter, '=' | '+' | '-' | '@' | '|' | '%' | '＝' | '＋' | '－' | '＠');
        if begins && sign {
            shown.push('\'');
        }
        begins = matches!(letter, ';' | ',' | '|' | '"') || begins && letter.is_whitespace();
        shown.push(letter);
    }
    shown
}
