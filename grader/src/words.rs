//! Answers in words: taken from the submissions, and laid out to be marked by a person.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;

use exercise_spec::{Exercise, exercise};

use crate::report::markdown::{block, counted, escaped};
use crate::repository;
use crate::text::harmless;

/// The file that has the questions, and in submissions the answers.
pub const FILE: &str = "answers.md";
/// As much of an answer as anybody reads.
const LONGEST: usize = 6_000;

/// What was written below the questions, by the slugs of the exercises.
pub type Words = BTreeMap<&'static str, String>;

/// The answers in a text that began as the file of the questions.
pub fn answers(text: &str) -> Words {
    let questions = fs::read_to_string(repository().join("exercises").join(FILE));
    let questions = sections(questions.as_deref().unwrap_or_default());
    let mut words = Words::new();
    for (slug, lines) in sections(text) {
        let asked = questions.get(slug).map_or(&[][..], Vec::as_slice);
        let own = lines.into_iter().filter(|line| !asked.contains(line));
        let own = own.collect::<Vec<_>>().join("\n");
        if !own.trim().is_empty() {
            words.insert(slug, harmless(own.trim(), LONGEST));
        }
    }
    words
}

/// Lines below the headings that are names of exercises.
fn sections(text: &str) -> BTreeMap<&'static str, Vec<&str>> {
    let mut sections: BTreeMap<&'static str, Vec<&str>> = BTreeMap::new();
    let mut at = None;
    for line in text.lines().map(str::trim_end) {
        if let Some(heading) = line.strip_prefix("## ") {
            at = exercise(heading.trim()).map(|exercise| exercise.slug);
        } else if let Some(slug) = at {
            sections.entry(slug).or_default().push(line);
        }
    }
    sections
}

/// All answers in words of a batch, one question after the other.
#[derive(Debug, Default)]
pub struct Collection {
    answers: BTreeMap<&'static str, Vec<(String, String)>>,
    /// Folders and exercises of answers that have no points yet.
    unmarked: Vec<(String, &'static str)>,
}

impl Collection {
    /// Adds the answers of a submission.
    pub fn add(&mut self, folder: &str, words: &Words, is_open: impl Fn(&str) -> bool) {
        for (slug, text) in words {
            self.answers.entry(slug).or_default().push((folder.to_owned(), text.clone()));
            if is_open(slug) {
                self.unmarked.push((folder.to_owned(), slug));
            }
        }
    }

    /// How many answers have no points yet.
    pub fn open(&self) -> usize {
        self.unmarked.len()
    }

    /// The answers for a person to read.
    pub fn markdown(&self, exercises: &[&'static Exercise]) -> String {
        let mut text = "# Answers in words\n\nEach question with the answers of all, to be read one after the other. \
                        `tests/rubrics` says what they are worth, and of a graded flight the page for instructors.\n"
            .to_owned();
        let asked = |exercise: &&&'static Exercise| self.answers.contains_key(exercise.slug);
        for exercise in exercises.iter().filter(asked) {
            let answers = &self.answers[exercise.slug];
            let title = escaped(exercise.title, 80);
            let _ = write!(text, "\n## {title}\n\n{}.\n", counted(answers.len(), "answer"));
            for (folder, answer) in answers {
                let _ = write!(text, "\n### {}\n\n{}", escaped(folder, 80), block(answer, ""));
            }
        }
        text
    }

    /// Rows for a file of marks, of what has none.
    ///
    /// # Errors
    ///
    /// When they cannot be written.
    pub fn rows(&self, to: &mut dyn std::io::Write) -> std::io::Result<()> {
        let mut writer = csv::Writer::from_writer(to);
        writer.write_record(crate::marks::COLUMNS)?;
        for (folder, slug) in &self.unmarked {
            writer.write_record([
                &crate::report::gradebook::cell(folder),
                *slug,
                "words",
                "",
                "",
            ])?;
        }
        writer.flush()
    }
}
