//! Markdown: the summary of a batch for a CI job, and the feedback to a student.

use std::fmt::Write as _;

use exercise_spec::Exercise;

use super::{
    COULD_NOT_GRADE, Detail, MARKS, NAME, PAGE, SENTENCE, Told, mark, passed, picture_file, points,
    reasons, who, words,
};
use crate::fly::GRADED_FLIGHT;
use crate::fly::answer::DECLARATION;
use crate::grade::{CheckGrade, ExerciseGrade, Grade, Outcome, Verdict};
use crate::roster::Differences;
use crate::text::{harmless, harmless_line};

/// As many lines as a table may have: GitHub shows a summary of a megabyte at most.
const LINES: usize = 2_000;

/// Text on one line that Markdown takes as it is.
pub fn escaped(text: &str, most: usize) -> String {
    let line = harmless_line(text, most);
    let mut shown = String::with_capacity(line.len());
    let mut before = ' ';
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let special = matches!(
            letter,
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '~' | '$' | '&' | '#' | '@'
        );
        // Neither `http://` nor `www.` becomes a link.
        let link = (letter == ':' && letters.peek() == Some(&'/'))
            || (letter == '.' && before.eq_ignore_ascii_case(&'w'));
        if special || link {
            shown.push('\\');
        }
        shown.push(letter);
        before = letter;
    }
    shown
}

/// A paragraph of escaped text that begins no list, heading or quote.
fn sentence(text: &str) -> String {
    let shown = escaped(text.trim(), SENTENCE);
    let digits = shown.trim_start_matches(|letter: char| letter.is_ascii_digit());
    match shown.chars().next() {
        Some('-' | '+' | '=') => format!("\\{shown}"),
        Some(digit) if digit.is_ascii_digit() && digits.starts_with(['.', ')']) => {
            let at = shown.len() - digits.len();
            format!("{}\\{digits}", &shown[..at])
        }
        _ => shown,
    }
}

/// Text in a block of code that it cannot leave, indented as a part of a list.
fn block(text: &str, indent: &str) -> String {
    fenced(&harmless(text.trim_end(), PAGE), indent)
}

/// The same of harmless text, whatever its length.
pub(crate) fn fenced(text: &str, indent: &str) -> String {
    let mut longest = 0;
    let mut run = 0;
    for letter in text.chars() {
        run = if letter == '`' { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    let fence = "`".repeat(longest.max(2) + 1);
    let mut shown = format!("{indent}{fence}text\n");
    for line in text.lines() {
        let _ = writeln!(shown, "{indent}{line}");
    }
    shown + indent + &fence + "\n"
}

/// What a student gets.
pub fn feedback(grade: &Grade, detail: Detail) -> String {
    let mut text = format!("# Feedback for {}\n\n", escaped(&who(grade), NAME));
    text += &total(grade);
    let late = grade.late.filter(|late| late.days > 0.0);
    if let (Some(late), Some(left)) = (late, grade.after_lateness()) {
        let _ = write!(
            text,
            "\nIt came {} days late, for which {} % are taken off: {} points are left.\n",
            points(late.days),
            points(late.percent),
            points(left)
        );
    }
    text += "\n| Exercise | Points | Public checks | Hidden checks |\n| --- | --: | --: | --: |\n";
    for exercise in &grade.exercises {
        let _ = writeln!(text, "| {} |", line_of(exercise).join(" | "));
    }
    for notice in grade.notices.iter().take(50) {
        let _ = write!(text, "\n{}\n", sentence(notice));
    }
    for exercise in &grade.exercises {
        text += &on_exercise(exercise, detail);
    }
    text
}

fn total(grade: &Grade) -> String {
    let all = points(grade.points());
    match grade.earned() {
        Some(earned) => format!("**{} of {all} points.**\n", points(earned)),
        None => {
            let earned: f64 = grade.exercises.iter().filter_map(ExerciseGrade::earned).sum();
            let names: Vec<String> =
                grade.ungraded().map(|exercise| escaped(&exercise.title, NAME)).collect();
            let open: f64 = grade.ungraded().map(ExerciseGrade::of).sum();
            format!(
                "**Not graded in full.** {} of {} points are earned so far; {} of {all} are open: \
                 {}.\n{COULD_NOT_GRADE}\n",
                points(earned),
                points(grade.points() - open),
                points(open),
                names.join(", ")
            )
        }
    }
}

fn line_of(exercise: &ExerciseGrade) -> [String; 4] {
    let of = points(exercise.of());
    let earned = exercise.earned().map_or_else(|| "open".to_owned(), points);
    let count = |hidden: bool| match passed(exercise, hidden) {
        (_, 0) => String::new(),
        (passed, all) => format!("{passed} of {all}"),
    };
    let [public, hidden] = match exercise.outcome {
        Outcome::Ran => [count(false), count(true)],
        Outcome::Missing => [format!("no file {}", file(exercise)), String::new()],
        Outcome::NotBegun => ["not begun".to_owned(), String::new()],
        Outcome::Refused(_) => ["refused".to_owned(), String::new()],
        Outcome::DoesNotCompile(_) => ["does not compile".to_owned(), String::new()],
        Outcome::CouldNotGrade(_) => ["could not be graded".to_owned(), String::new()],
        Outcome::InWords => ["in words".to_owned(), String::new()],
    };
    [escaped(&exercise.title, NAME), format!("{earned} of {of}"), public, hidden]
}

/// The name of an answer's file as code.
fn file(exercise: &ExerciseGrade) -> String {
    if exercise.outcome == Outcome::InWords {
        return format!("`{}`", crate::words::FILE);
    }
    if exercise.exercise == GRADED_FLIGHT.slug {
        return format!("`{DECLARATION}`, with the folders beside it");
    }
    format!("`{}.rs`", harmless_line(&exercise.exercise, NAME).replace(['`', '|'], ""))
}

/// A section on an exercise, where there is something to say that the table does not.
fn on_exercise(exercise: &ExerciseGrade, detail: Detail) -> String {
    let mut text = String::new();
    if let Some(told) = Told::of_exercise(exercise) {
        text += &format!("\n{}\n", sentence(&told.sentence));
        if !told.page.is_empty() {
            text += &format!("\n{}", block(&told.page, ""));
        }
    }
    let wrong = |check: &&CheckGrade| check.verdict != Verdict::Passed;
    let mut checks: Vec<&CheckGrade> = exercise.checks.iter().filter(wrong).collect();
    while !checks.is_empty() {
        let told = detail.of_check(exercise, checks[0]);
        // What would be said over and over is said once.
        let (same, rest): (Vec<_>, Vec<_>) =
            checks.into_iter().partition(|check| detail.of_check(exercise, check) == told);
        text += &on_checks(&same, &told);
        let drawn = same.into_iter().filter(|check| detail.picture(check).is_some());
        for file in drawn.map(|check| picture_file(exercise, check)) {
            let _ = writeln!(text, "\n  ![Expected and obtained, drawn]({file})");
        }
        checks = rest;
    }
    if matches!(exercise.outcome, Outcome::Missing | Outcome::NotBegun) {
        text.clear();
    }
    text += &by_person(exercise);
    if text.is_empty() {
        return String::new();
    }
    let title = escaped(&exercise.title, NAME);
    format!("\n## {title}\n\nThe file is {}.\n{text}", file(exercise))
}

/// What a person gave, and what a person says.
fn by_person(exercise: &ExerciseGrade) -> String {
    let mut text = String::new();
    if let Some(marked) = exercise.marked {
        let (earned, of) = (points(marked), points(exercise.points));
        let _ = write!(text, "\nYour instructor gave the program {earned} of {of} points.\n");
    }
    if let Some(words) = exercise.words {
        let (earned, of) = (points(words.earned), points(words.of));
        let _ = write!(text, "\nThe answer in words earns {earned} of {of} points.\n");
    }
    for comment in &exercise.comments {
        let _ = write!(text, "\n{}\n", sentence(comment));
    }
    text
}

fn on_checks(checks: &[&CheckGrade], told: &Told) -> String {
    let name = |check: &CheckGrade| {
        let hidden = if check.hidden { " (hidden)" } else { "" };
        format!("**{}**{hidden}", escaped(&words(&check.name), NAME))
    };
    let names: Vec<String> = checks.iter().copied().map(name).collect();
    let mut text = format!("\n- {}", names.join(", "));
    match told.sentence.is_empty() {
        true => text += "\n",
        false => text += &format!("\\\n  {}\n", sentence(&told.sentence)),
    }
    if !told.page.is_empty() {
        text += &format!("\n{}", block(&told.page, "  "));
    }
    text
}

/// Makes the summary of a batch, grade by grade.
#[derive(Debug)]
pub struct Summary {
    exercises: Vec<&'static str>,
    lines: String,
    count: usize,
    /// Reasons, and for whose submissions and exercises they hold.
    ungraded: Vec<(String, Vec<String>)>,
    ungraded_count: usize,
    /// Submissions in which no answer was found.
    empty: Vec<String>,
    earned: f64,
    points: f64,
}

impl Summary {
    /// Begins one.
    pub fn new(exercises: &[&'static Exercise]) -> Self {
        let exercises = exercises.iter().map(|exercise| exercise.slug).collect();
        Self {
            exercises,
            lines: String::new(),
            count: 0,
            ungraded: Vec::new(),
            ungraded_count: 0,
            empty: Vec::new(),
            earned: 0.0,
            points: 0.0,
        }
    }

    /// Adds a grade.
    pub fn add(&mut self, grade: &Grade) {
        self.count += 1;
        self.points = self.points.max(grade.points());
        match grade.earned() {
            Some(earned) => self.earned += earned,
            None => {
                self.ungraded_count += 1;
                self.add_ungraded(grade);
            }
        }
        if grade.is_empty() {
            self.empty.push(escaped(&who(grade), NAME));
        }
        if self.count > LINES {
            return;
        }
        let _ = write!(self.lines, "| {} ", escaped(&who(grade), NAME));
        let _ = write!(self.lines, "| {} ", grade.earned().map_or_else(|| "?".to_owned(), points));
        for slug in &self.exercises {
            let found = grade.exercises.iter().find(|exercise| exercise.exercise == *slug);
            let _ = write!(self.lines, "| {} ", found.map(mark).unwrap_or_default());
        }
        self.lines += "|\n";
    }

    fn add_ungraded(&mut self, grade: &Grade) {
        if self.ungraded_count > LINES / 10 {
            return;
        }
        for (why, exercises) in reasons(grade) {
            let names: String = exercises.iter().map(|slug| format!(", `{slug}`")).collect();
            let who = escaped(&who(grade), NAME) + &names;
            match self.ungraded.iter_mut().find(|(known, _)| *known == why) {
                Some((_, whose)) => whose.push(who),
                None => self.ungraded.push((why, vec![who])),
            }
        }
    }

    /// The summary, with what stood around the compiler and where the roster does not agree.
    pub fn finish(self, mark: &str, sandbox: &str, differences: &Differences) -> String {
        let graded = self.count - self.ungraded_count;
        let mut text = format!("# Grades\n\n{}", counted(self.count, "submission"));
        if self.ungraded_count > 0 {
            let _ = write!(text, ", of which {} could not be graded in full", self.ungraded_count);
        }
        text += ". ";
        if graded > 0 {
            let mean = points(self.earned / graded as f64);
            let _ = write!(text, "The mean is {mean} of {} points. ", points(self.points));
        }
        let _ = writeln!(text, "The hidden instances are {mark}. {}", escaped(sandbox, SENTENCE));
        let _ = write!(text, "\n| Submission | Points |");
        for (index, _) in self.exercises.iter().enumerate() {
            let _ = write!(text, " {} |", index + 1);
        }
        text +=
            &format!("\n| --- | --: |{}\n{}", " --: |".repeat(self.exercises.len()), self.lines);
        if self.count > LINES {
            let _ = writeln!(text, "\nand {} more, in gradebook.csv", self.count - LINES);
        }
        let named = self.exercises.iter().enumerate();
        let named: Vec<String> =
            named.map(|(index, slug)| format!("{} `{slug}`", index + 1)).collect();
        text += &format!("\n{}.\n\n{MARKS}\n", named.join(", "));
        if !self.ungraded.is_empty() {
            text += "\n## Could not be graded\n\n";
        }
        for (why, whose) in &self.ungraded {
            let _ = writeln!(text, "- {}: {}", whose.join("; "), escaped(why, SENTENCE));
        }
        let Differences { unknown, absent, doubtful } = differences;
        let shown = |name: &String| escaped(name, NAME);
        let absent =
            absent.iter().map(|(folder, name)| format!("{} ({})", shown(name), shown(folder)));
        let doubtful = doubtful.iter().map(|sentence| escaped(sentence, SENTENCE));
        text += &section("Not on the roster", unknown.iter().map(shown).collect());
        text += &section("On the roster, and handed in nothing", absent.collect());
        text += &section("No answer found in", self.empty);
        text + &section("Rows of the roster that are in doubt", doubtful.collect())
    }
}

/// A section with a list of escaped lines, if there is anything to list.
fn section(title: &str, mut lines: Vec<String>) -> String {
    const LISTED: usize = LINES / 4;
    if lines.is_empty() {
        return String::new();
    }
    let others = lines.len().saturating_sub(LISTED);
    lines.truncate(LISTED);
    let mut text = format!("\n## {title}\n\n- {}\n", lines.join("\n- "));
    if others > 0 {
        let _ = writeln!(text, "\nand {others} more, in gradebook.csv");
    }
    text
}

/// A number and what it counts.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
