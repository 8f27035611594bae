//! The table in a terminal of eighty columns.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use comfy_table::{
    Cell, CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table, TableStyle, Width,
};
use exercise_spec::Exercise;

use super::markdown::counted;
use super::{MARKS, SENTENCE, mark, passed, points, reasons, who, words};
use crate::grade::{ExerciseGrade, Grade, Outcome};
use crate::roster::Differences;
use crate::text::harmless_line;

/// Columns of the terminal.
const WIDTH: usize = 80;
/// Columns that a name has at most.
const NAME: u16 = 20;
/// Columns that a name has at least.
const NARROW: u16 = 12;
/// As many lines on what could not be graded or is not on the roster as one reads.
const LINES: usize = 20;

/// Makes the table of a batch, grade by grade.
pub struct Terminal {
    exercises: Vec<&'static Exercise>,
    rows: Vec<Vec<String>>,
    count: usize,
    graded: usize,
    earned: f64,
    sums: Vec<(f64, usize)>,
    /// The one grade of a batch that has no other.
    alone: Option<Grade>,
    marks: BTreeSet<String>,
    ungraded: Vec<String>,
    /// Submissions in which no answer was found.
    empty: Vec<String>,
    points: f64,
}

impl Terminal {
    /// Begins one.
    pub fn new(exercises: &[&'static Exercise]) -> Self {
        Self {
            rows: Vec::new(),
            sums: vec![(0.0, 0); exercises.len()],
            exercises: exercises.to_vec(),
            count: 0,
            graded: 0,
            earned: 0.0,
            alone: None,
            marks: BTreeSet::new(),
            ungraded: Vec::new(),
            empty: Vec::new(),
            points: 0.0,
        }
    }

    /// Adds a grade.
    pub fn add(&mut self, grade: &Grade) {
        self.count += 1;
        self.points = self.points.max(grade.points());
        self.alone = (self.count == 1).then(|| grade.clone());
        if let Some(earned) = grade.earned() {
            self.graded += 1;
            self.earned += earned;
        }
        let mut row = vec![name(grade), number(grade.earned())];
        for (exercise, (sum, count)) in self.exercises.iter().zip(&mut self.sums) {
            let found = grade.exercises.iter().find(|found| found.exercise == exercise.slug);
            if let Some(earned) = found.and_then(ExerciseGrade::earned) {
                *sum += earned;
                *count += 1;
            }
            let mark = found.map(mark).unwrap_or_default();
            if !mark.starts_with(|letter: char| letter.is_ascii_digit()) {
                self.marks.insert(mark.clone());
            }
            row.push(mark);
        }
        self.rows.push(row);
        if grade.is_empty() && self.empty.len() <= LINES {
            self.empty.push(name(grade));
        }
        if self.ungraded.len() <= LINES {
            self.ungraded.extend(lines_of(grade));
        }
    }

    /// The table and what is to be said below it.
    pub fn finish(mut self, mark: &str, sandbox: &str, differences: &Differences) -> String {
        let mut text = match self.alone.take() {
            Some(grade) => one(&grade),
            None => self.many(),
        };
        if !self.ungraded.is_empty() {
            text += "\nCould not be graded, which is no zero:\n";
            text += &listed(&self.ungraded);
        }
        if !self.empty.is_empty() {
            text += "\nNo answer found in:\n";
            text += &listed(&self.empty);
        }
        text += &on_roster(differences);
        let _ = write!(text, "\n{}", wrapped(&format!("Hidden instances {mark}. {sandbox}"), ""));
        text
    }

    fn many(&mut self) -> String {
        let mut mean = vec!["mean of all".to_owned()];
        mean.push(number((self.graded > 0).then(|| self.earned / self.graded as f64)));
        mean.extend(self.sums.iter().map(|(sum, count)| {
            if *count > 0 { points(sum / *count as f64) } else { String::new() }
        }));
        self.rows.extend([vec![String::new(); mean.len()], mean]);
        let of = points(self.points);
        let of = if of.len() > 3 { format!("of\n{of}") } else { format!("of {of}") };
        let mut header = vec!["Submission".to_owned(), of];
        header.extend((1..=self.exercises.len()).map(|index| index.to_string()));
        let mut text = String::new();
        for block in blocks(&header, &self.rows) {
            let _ = writeln!(text, "{}\n", part(&header, &self.rows, &block).trim_fmt());
        }
        let half = self.exercises.len().div_ceil(2);
        for index in 0..half {
            let entry = |index: usize| {
                let exercise = self.exercises.get(index)?;
                Some(format!("{:>4} {:32}", index + 1, exercise.slug))
            };
            let right = entry(index + half).unwrap_or_default();
            let line = entry(index).unwrap_or_default() + &right;
            let _ = writeln!(text, "{}", line.trim_end());
        }
        if self.marks.iter().any(|mark| !mark.is_empty()) {
            let _ = write!(text, "\n{}", wrapped(MARKS, ""));
        }
        let open = self.count - self.graded;
        let _ = write!(text, "\n{} graded", counted(self.graded, "submission"));
        let _ = match open {
            0 => writeln!(text, "."),
            _ => writeln!(text, ", {open} could not be graded in full."),
        };
        text
    }
}

/// The table of one submission: a line for each exercise.
fn one(grade: &Grade) -> String {
    let mut table = Table::new();
    for exercise in &grade.exercises {
        let count = |hidden: bool| match passed(exercise, hidden) {
            (_, 0) => String::new(),
            (passed, all) => format!("{passed} of {all}"),
        };
        let earned = exercise.earned().map_or_else(|| "?".to_owned(), points);
        table.add_row(vec![
            harmless_line(&exercise.exercise, usize::from(NAME)),
            format!("{earned} of {}", points(exercise.of())),
            count(false),
            count(true),
            remark(exercise),
        ]);
    }
    let header = ["Exercise", "Points", "Public", "Hidden", "Remarks"].map(str::to_owned);
    style(&mut table, header.to_vec());
    if let Some(column) = table.column_mut(4) {
        column.set_cell_alignment(CellAlignment::Left);
    }
    let total = match grade.earned() {
        Some(earned) => format!("{} of {} points", points(earned), points(grade.points())),
        None => "not graded in full".to_owned(),
    };
    let mut text = format!("{}: {total}\n\n{}\n", name(grade), table.trim_fmt());
    for notice in grade.notices.iter().take(LINES) {
        let _ = write!(text, "\n{}", wrapped(notice, ""));
    }
    text
}

/// Why a submission could not be graded: a line for each reason.
fn lines_of(grade: &Grade) -> Vec<String> {
    let line = |(why, exercises): (String, Vec<&str>)| {
        let names: String = exercises.iter().map(|slug| format!(", {slug}")).collect();
        harmless_line(&format!("{}{names}: {why}", who(grade)), SENTENCE)
    };
    reasons(grade).into_iter().map(line).collect()
}

fn remark(exercise: &ExerciseGrade) -> String {
    match &exercise.outcome {
        _ if exercise.earned().is_none() => "could not be graded".to_owned(),
        Outcome::Missing => "no file".to_owned(),
        Outcome::NotBegun => "not begun".to_owned(),
        Outcome::Refused(_) => "refused".to_owned(),
        Outcome::DoesNotCompile(_) => "does not compile".to_owned(),
        Outcome::InWords => "in words".to_owned(),
        _ => {
            let names: Vec<String> = exercise.misconceptions().into_iter().map(words).collect();
            harmless_line(&names.join(", "), 160)
        }
    }
}

/// A rule below the heading, and no frame.
const RULED: TableStyle =
    TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// A ruled heading, and numbers to the right.
fn style(table: &mut Table, header: Vec<String>) {
    let cells = header.into_iter().map(Cell::new_owned);
    table.set_header(cells.collect::<Vec<_>>());
    table
        .load_style(RULED)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDTH as u16);
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((u16::from(index > 0), u16::from(index == 0)));
        if index > 0 {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
}

/// Columns of numbers with the widths that they need, in as few tables of the terminal's width as hold
/// them, of which none is much wider than another.
fn blocks(header: &[String], rows: &[Vec<String>]) -> Vec<Vec<(usize, u16)>> {
    let columns: Vec<(usize, u16)> = (1..header.len())
        .map(|column| {
            let cells = rows.iter().map(|row| &row[column]).chain([&header[column]]);
            let lines = cells.flat_map(|cell| cell.lines());
            (column, lines.map(|line| line.chars().count()).max().unwrap_or(0) as u16)
        })
        .collect();
    let fewest = split(&columns, WIDTH as u16).len();
    let narrowest = (NARROW..WIDTH as u16).find(|width| split(&columns, *width).len() == fewest);
    split(&columns, narrowest.unwrap_or(WIDTH as u16))
}

/// The columns in turn, as many in a table of this width as fit beside the names, and one at least.
fn split(columns: &[(usize, u16)], width: u16) -> Vec<Vec<(usize, u16)>> {
    let mut blocks: Vec<Vec<(usize, u16)>> = Vec::new();
    let mut taken = width;
    for &(column, needed) in columns {
        taken += 1 + needed;
        if taken > width {
            blocks.push(Vec::new());
            taken = NARROW + 1 + needed;
        }
        if let Some(block) = blocks.last_mut() {
            block.push((column, needed));
        }
    }
    blocks
}

/// The table of some columns, each beside the names. Between columns there is one that is empty.
fn part(header: &[String], rows: &[Vec<String>], block: &[(usize, u16)]) -> Table {
    let of = |row: &[String]| -> Vec<String> {
        let numbers = block.iter().map(|(column, _)| row[*column].clone());
        std::iter::once(row[0].clone()).chain(numbers).collect()
    };
    let mut table = Table::new();
    table.add_rows(rows.iter().map(|row| of(row)));
    style(&mut table, of(header));
    let numbers: u16 = block.iter().map(|(_, width)| width + 1).sum();
    let names = (WIDTH as u16).saturating_sub(numbers).clamp(NARROW, NAME);
    table.set_width(names + numbers);
    let widths = std::iter::once(names).chain(block.iter().map(|(_, width)| *width));
    for (column, width) in table.column_iter_mut().zip(widths) {
        column.set_padding((0, 0)).set_constraint(ColumnConstraint::Absolute(Width::Fixed(width)));
    }
    table
}

fn name(grade: &Grade) -> String {
    harmless_line(&who(grade), 2 * usize::from(NAME))
}

fn number(number: Option<f64>) -> String {
    number.map_or_else(|| "?".to_owned(), points)
}

fn on_roster(differences: &Differences) -> String {
    let mut text = String::new();
    if !differences.unknown.is_empty() {
        text += "\nNot on the roster:\n";
        text += &listed(&differences.unknown);
    }
    if !differences.absent.is_empty() {
        let absent = differences.absent.iter();
        let absent: Vec<String> =
            absent.map(|(folder, name)| format!("{name} ({folder})")).collect();
        text += "\nOn the roster, and handed in nothing:\n";
        text += &listed(&absent);
    }
    if !differences.doubtful.is_empty() {
        text += "\nRows of the roster that are in doubt:\n";
        text += &listed(&differences.doubtful);
    }
    text
}

fn listed(lines: &[String]) -> String {
    let mut text = String::new();
    for line in lines.iter().take(LINES) {
        text += &wrapped(line, "  ");
    }
    if lines.len() > LINES {
        text += "  and more, in summary.md\n";
    }
    text
}

/// Text in lines that fit the terminal; those after the first go in further.
pub fn wrapped(text: &str, indent: &str) -> String {
    let text = harmless_line(text, SENTENCE);
    let mut shown = String::new();
    let mut line = indent.to_owned();
    for word in text.split_whitespace() {
        let empty = line.trim().is_empty();
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            let _ = writeln!(shown, "{line}");
            line = format!("{indent}{indent}{word}");
            continue;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
    }
    shown + line.trim_end() + "\n"
}
