//! What a person decides: points for answers in words, points in place of the grader's, and comments.
//!
//! They stand in a file of that person, which the grader reads and never writes. Whatever is graded
//! again, they are laid over it.

use std::collections::BTreeMap;
use std::path::Path;

use exercise_spec::exercise;

use crate::fly::GRADED_FLIGHT;
use crate::grade::{Grade, WordsGrade};
use crate::points::Points;
use crate::report::gradebook::cell;
use crate::roster::{separator, text};
use crate::text::{harmless, harmless_line};
use crate::words;

/// The columns of the file.
pub const COLUMNS: [&str; 5] = ["folder", "exercise", "part", "points", "comment"];
/// As long as a comment may be.
const COMMENT: usize = 1_000;

const FORM: &str = "the first line is `folder,exercise,part,points,comment`; a part is `words` or `program`, and points \
                    may be left out beside a comment";

/// The marks of a file, by folder, exercise and whether they are for words.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Marks {
    rows: BTreeMap<(String, String, bool), Mark>,
}

#[derive(Debug, Clone, PartialEq)]
struct Mark {
    points: Option<f64>,
    comment: String,
}

impl Marks {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// A sentence with the line when it cannot be read, is of another form, names an exercise or a
    /// question that there is not, has more points than there are, or says something twice.
    pub fn read(path: &Path, points: &Points) -> Result<Self, String> {
        let bytes = std::fs::read(path)
            .map_err(|error| format!("cannot read the marks {}: {error}", path.display()))?;
        let parsed = text(&bytes).and_then(|text| Self::parse(text, points));
        parsed.map_err(|error| format!("the marks {}: {error}", path.display()))
    }

    /// The same from text.
    ///
    /// # Errors
    ///
    /// As [`Marks::read`].
    pub fn parse(text: &str, points: &Points) -> Result<Self, String> {
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .delimiter(separator(text))
            .from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| format!("{error}; {FORM}"))?.clone();
        let mut columns = [0; COLUMNS.len()];
        for (column, name) in columns.iter_mut().zip(COLUMNS) {
            let found = headers.iter().position(|header| header.eq_ignore_ascii_case(name));
            *column =
                found.ok_or_else(|| format!("line 1: there is no column `{name}`; {FORM}"))?;
        }
        let mut rows = BTreeMap::new();
        for row in reader.records() {
            let row = row.map_err(|error| format!("{error}; {FORM}"))?;
            let line = row.position().map_or(0, csv::Position::line);
            let cells = columns.map(|column| row.get(column).unwrap_or_default());
            let (place, mark) = mark(cells, points).map_err(|why| format!("line {line}: {why}"))?;
            let Some(mark) = mark else { continue };
            if rows.insert(place, mark).is_some() {
                return Err(format!(
                    "line {line}: the same was marked in a line before; delete one"
                ));
            }
        }
        Ok(Self { rows })
    }

    /// Lays the marks of a submission over its grade. Words without a mark do not count yet, and where there may be
    /// some, having none is not marked either.
    pub fn lay_over(
        &self,
        grade: &mut Grade,
        folders: &[&str],
        has_words: impl Fn(&str) -> bool,
        points: &Points,
    ) {
        for exercise in &mut grade.exercises {
            if let Some(mark) = self.of(folders, &exercise.exercise, false) {
                exercise.marked = mark.points;
                exercise.comments.extend(Some(mark.comment.clone()).filter(|it| !it.is_empty()));
            }
            let of = points.of_words(&exercise.exercise);
            let mark = self.of(folders, &exercise.exercise, true);
            exercise
                .comments
                .extend(mark.map(|mark| mark.comment.clone()).filter(|it| !it.is_empty()));
            let earned = match mark.and_then(|mark| mark.points) {
                Some(points) => Some(points),
                None if has_words(&exercise.exercise) => None,
                // Who has written nothing waits for nobody.
                None => Some(0.0).filter(|_| !self.rows.is_empty()),
            };
            exercise.words = earned.filter(|_| of > 0.0).map(|earned| WordsGrade { of, earned });
        }
    }

    /// Folders that have marks and are none of these.
    pub fn strangers(&self, known: impl Fn(&str) -> bool) -> Vec<String> {
        let mut folders: Vec<String> =
            self.rows.keys().map(|(folder, ..)| folder.clone()).filter(|it| !known(it)).collect();
        folders.dedup();
        folders
    }

    fn of(&self, folders: &[&str], exercise: &str, words: bool) -> Option<&Mark> {
        let mark = |folder: &&str| self.rows.get(&(cell(folder), exercise.to_owned(), words));
        folders.iter().find_map(mark)
    }
}

/// What a row says, if it says anything.
#[allow(clippy::type_complexity, reason = "a key and its value")]
fn mark(
    [folder, slug, part, number, comment]: [&str; 5],
    points: &Points,
) -> Result<((String, String, bool), Option<Mark>), String> {
    if words::question(slug).is_none() {
        return Err(words::unknown(&harmless_line(slug, 60)));
    }
    let words = match part {
        "words" => true,
        "program" if exercise(slug).is_none() && slug != GRADED_FLIGHT.slug => {
            return Err(format!("`{slug}` is a chapter and has no program; its part is `words`"));
        }
        "program" => false,
        _ => return Err(format!("the part is `{}`; {FORM}", harmless_line(part, 60))),
    };
    let most = if words { points.of_words(slug) } else { points.of(slug) };
    let number = match number {
        "" => None,
        number => {
            // A spreadsheet may write a comma.
            let value = number.replace(',', ".").parse().ok();
            Some(value.filter(|value| (0.0..=most).contains(value)).ok_or_else(|| {
                format!("`{}` is no number of points from 0 to {most}", harmless_line(number, 60))
            })?)
        }
    };
    let comment = harmless(comment, COMMENT);
    let mark =
        (number.is_some() || !comment.is_empty()).then_some(Mark { points: number, comment });
    // A spreadsheet may have taken away what makes a cell harmless.
    Ok(((cell(folder), slug.to_owned(), words), mark))
}
