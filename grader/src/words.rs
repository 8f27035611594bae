//! Answers in words: taken from the submissions, and laid out to be marked by a person.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;

use exercise_spec::{CHAPTERS, Question};

use crate::fly::GRADED_FLIGHT;
use crate::points;
use crate::report::markdown::{counted, escaped, fenced};
use crate::repository;
use crate::text::{harmless, harmless_line};

/// The file that has the questions, and in submissions the answers.
pub const FILE: &str = "answers.md";
/// As much of an answer as anybody reads.
pub const LONGEST: usize = 6_000;
/// What stood above the questions in an older edition.
const FORMER: &str = "Write below each question. Nobody but a person reads this file.";

/// What was written below the questions, by their slugs.
pub type Words = BTreeMap<&'static str, String>;

/// What is asked under a name; of a graded flight, too.
pub fn question(slug: &str) -> Option<Question> {
    let flight = Some(GRADED_FLIGHT.question()).filter(|flight| flight.slug == slug);
    flight.or_else(|| exercise_spec::question(slug))
}

/// That nothing is asked under a name, and what is.
pub fn unknown(slug: &str) -> String {
    let chapters: Vec<&str> = CHAPTERS.iter().map(|question| question.slug).collect();
    format!("{}, and in words {}", points::unknown(slug), chapters.join(", "))
}

/// What the file asks, in its order, which is that of the book.
pub fn asked() -> Vec<Question> {
    questions().lines().filter_map(heading).collect()
}

fn questions() -> String {
    fs::read_to_string(repository().join("exercises").join(FILE)).unwrap_or_default()
}

/// Whether a file is called like that of the answers, or as a browser or a student calls a copy of it.
pub fn is_file(name: &str) -> bool {
    let name = name.to_lowercase();
    name.starts_with("answers") && name.ends_with(".md")
}

/// What stands in a text that began as the file of the questions.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// Answers below the headings of questions.
    pub words: Words,
    /// Answers that are longer than anybody reads.
    pub cut: Vec<&'static str>,
    /// A line that may belong to an answer, and nobody knows to which.
    pub astray: Option<String>,
}

impl Written {
    /// Reads a text.
    pub fn of(text: &str) -> Self {
        let questions = questions();
        let asked = sections(&questions);
        let sections = sections(text.trim_start_matches('\u{feff}'));
        let (mut words, mut cut) = (Words::new(), Vec::new());
        for (slug, lines) in &sections {
            let asked = asked.get(slug).map_or(&[][..], Vec::as_slice);
            let own = lines.iter().copied().filter(|line| line.is_empty() || !asked.contains(line));
            let own = own.collect::<Vec<_>>().join("\n");
            if let (Some(slug), false) = (slug, own.trim().is_empty()) {
                words.insert(*slug, harmless(own.trim(), LONGEST));
                cut.extend(own.trim().chars().nth(LONGEST).map(|_| *slug));
            }
        }
        Self { words, cut, astray: astray(&sections, &questions) }
    }
}

/// The first line of somebody's own before any heading of a question, or a heading that names a question in a way
/// that is not read.
fn astray(sections: &Sections, questions: &str) -> Option<String> {
    let handed_out =
        |line: &str| line == FORMER || questions.lines().any(|it| it.trim_end() == line);
    let own = |line: &str| line.contains(char::is_alphanumeric) && !handed_out(line);
    let missing = |question: Question| !sections.contains_key(&Some(question.slug));
    let names = |word: &String| exercise_spec::question(word).is_some_and(missing);
    let astray = sections.iter().find_map(|(slug, lines)| {
        lines.iter().find(|line| match (slug, line.starts_with('#')) {
            (None, heading) => !heading && own(line),
            (Some(_), heading) => heading && parts(line).iter().any(names),
        })
    });
    astray.map(|line| harmless_line(line.trim(), 60))
}

/// The question of a line that is a heading.
fn heading(line: &str) -> Option<Question> {
    exercise_spec::question(line.strip_prefix("## ")?.trim())
}

/// The question that a heading begins with, whatever its capitals and what follows.
fn changed(line: &str) -> Option<Question> {
    exercise_spec::question(parts(line.strip_prefix("## ")?).first()?)
}

/// The words of a line, in small letters.
fn parts(line: &str) -> Vec<String> {
    let words = line.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    words.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

/// Lines below the headings that name a question, and those before the first of them.
type Sections<'a> = BTreeMap<Option<&'static str>, Vec<&'a str>>;

/// Takes a text apart. Where the heading of a question stands as it was handed out, no other one is its.
fn sections(text: &str) -> Sections<'_> {
    let kept: BTreeSet<&str> =
        text.lines().filter_map(heading).map(|question| question.slug).collect();
    let own = |question: &Question| !kept.contains(question.slug);
    let mut sections = Sections::new();
    let mut at = None;
    for line in text.lines().map(str::trim_end) {
        match heading(line).or_else(|| changed(line).filter(own)) {
            Some(question) => at = Some(question.slug),
            None => sections.entry(at).or_default().push(line),
        }
    }
    sections
}

/// All answers in words of a batch, one question after the other.
#[derive(Debug, Default)]
pub struct Collection {
    answers: BTreeMap<&'static str, Vec<(String, String)>>,
    /// Folders and questions of answers that have no points yet.
    unmarked: Vec<(String, &'static str)>,
    /// How many of these are there to be read.
    read: usize,
    /// Folders with others.
    unread: Vec<String>,
}

impl Collection {
    /// Adds the answers of a submission, and the questions that are open: those without points to which it has words,
    /// or may have some that nobody has read.
    pub fn add(&mut self, folder: &str, words: &Words, open: &[&'static str]) {
        for (slug, text) in words {
            self.answers.entry(slug).or_default().push((folder.to_owned(), text.clone()));
        }
        let read = open.iter().filter(|slug| words.contains_key(*slug)).count();
        self.read += read;
        self.unread.extend((read < open.len()).then(|| folder.to_owned()));
        self.unmarked.extend(open.iter().map(|slug| (folder.to_owned(), *slug)));
    }

    /// How many answers have no points yet.
    pub fn open(&self) -> usize {
        self.read
    }

    /// Folders with questions that are open because nobody has read an answer.
    pub fn unread(&self) -> &[String] {
        &self.unread
    }

    /// The answers for a person to read.
    pub fn markdown(&self, questions: &[Question]) -> String {
        let mut text = "# Answers in words\n\nEach question with the answers of all, to be read one after the other. \
                        `tests/rubrics` says what they are worth, and of a graded flight the page for instructors.\n"
            .to_owned();
        for question in questions {
            let Some(answers) = self.answers.get(question.slug) else { continue };
            let title = escaped(question.title, 80);
            let count = counted(answers.len(), "answer");
            let _ = write!(text, "\n## {title}\n\n{count} to `{}`.\n", question.slug);
            for (folder, answer) in answers {
                let _ = write!(text, "\n### {}\n\n{}", escaped(folder, 80), fenced(answer, ""));
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
            let folder = crate::report::gradebook::cell(folder);
            writer.write_record([&*folder, *slug, "words", "", ""])?;
        }
        writer.flush()
    }
}
