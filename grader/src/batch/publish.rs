//! Writes every report of a batch, grade by grade.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::sync::atomic::Ordering;

use serde::ser::{Error as _, SerializeSeq, SerializeStruct};
use serde::{Serialize, Serializer};

use super::kept::Kept;
use super::{Finished, Judging, Plan, Trouble, calmly};
use crate::changes::Changes;
use crate::grade::{ExerciseGrade, Grade, Late, Outcome, VERSION};
use crate::items::Items;
use crate::report::gradebook::{Gradebook, cell};
use crate::report::markdown::{self, Summary};
use crate::report::terminal::{Terminal, wrapped};
use crate::report::{gradescope, junit, picture_file};
use crate::repository;
use crate::similarity::Similarity;
use crate::submission::Collected;
use crate::text::harmless_line;
use crate::words::{Collection, Words};

/// Writes every report, and hands back what the terminal shows.
pub fn publish(plan: &Plan, kept: &Kept, judge: &impl Judging) -> Result<Finished, Trouble> {
    let sandbox = &*judge.sandbox();
    let seed = kept.seed();
    let mark = seed.mark();
    let differences = &plan.matches.differences;
    let (similarity, words, unread) = read_again(plan, judge);
    let sheet = Sheet { plan, kept, words, unread };
    let mut collection = Collection::default();
    let mut terminal = Terminal::new(&plan.exercises);
    let mut summary = Summary::new(&plan.exercises);
    let mut items = Items::new(&plan.exercises);
    let mut changes = Changes::default();
    let mut ungraded = 0;
    let mut alone = String::new();
    for name in plan.names() {
        let grade = sheet.grade(name)?;
        one(plan, kept, &grade)?;
        sheet.collect(name, &grade, &mut collection);
        terminal.add(&grade);
        summary.add(&grade);
        items.add(&grade);
        changes.add(sheet.former(name)?.as_ref(), &grade);
        ungraded += usize::from(grade.earned().is_none());
        if plan.submissions.len() == 1 {
            alone = format!("\n{}", markdown::feedback(&grade, plan.detail));
        }
    }
    let whole = Whole { sheet: &sheet, sandbox };
    kept.report_by("grade.json", |file| {
        serde_json::to_writer_pretty(file, &whole).map_err(std::io::Error::from)
    })?;
    kept.report_by("gradebook.csv", |file| gradebook(&sheet, file))?;
    kept.report_by("junit.xml", |file| junit_of_all(&sheet, file))?;
    kept.report("items.md", items.markdown().as_bytes())?;
    let compares = plan.exercises.iter().any(|exercise| !exercise.functions.is_empty());
    if compares {
        kept.report("similarity.md", similarity.markdown().as_bytes())?;
    }
    kept.report("words.md", collection.markdown(&plan.questions).as_bytes())?;
    kept.report_by("unmarked.csv", |file| collection.rows(file))?;
    let summary = summary.finish(&mark, sandbox, differences) + &alone;
    kept.report("summary.md", summary.as_bytes())?;
    let mut told = terminal.finish(&mark, sandbox, differences);
    told += &had(plan, kept);
    told += &regrade(plan, kept, changes)?;
    told += &by_person(&sheet, &collection);
    told += &wrapped(
        &format!(
            "Reports in {}: summary.md, gradebook.csv, junit.xml, items.md, {}words.md, \
             unmarked.csv, grade.json, and for each submission feedback.md, results.json and junit.xml.",
            kept.folder().display(),
            if compares { "similarity.md, " } else { "" }
        ),
        "",
    );
    Ok(Finished { seed, graded: plan.submissions.len() - ungraded, ungraded, told })
}

/// How many grades were there before, when a batch goes on that was stopped.
fn had(plan: &Plan, kept: &Kept) -> String {
    let had = plan.had.load(Ordering::Relaxed);
    if had == 0 || kept.former_seed().is_some() {
        return String::new();
    }
    format!("\n{had} of {} were graded already.\n", plan.submissions.len())
}

/// The reports on one submission.
fn one(plan: &Plan, kept: &Kept, grade: &Grade) -> Result<(), Trouble> {
    let name = &grade.submission;
    let junit = junit::xml(grade, plan.detail).map_err(Trouble::CouldNotGrade)?;
    kept.report_on(name, "feedback.md", markdown::feedback(grade, plan.detail).as_bytes())?;
    kept.report_on(name, "results.json", gradescope::json(grade, plan.detail).as_bytes())?;
    kept.report_on(name, "junit.xml", junit.as_bytes())?;
    pictures(plan, kept, grade)
}

/// The pictures of checks that failed, and none of a former answer.
fn pictures(plan: &Plan, kept: &Kept, grade: &Grade) -> Result<(), Trouble> {
    let name = &grade.submission;
    for exercise in &grade.exercises {
        for check in &exercise.checks {
            let file = picture_file(exercise, check);
            match plan.detail.picture(check) {
                Some(picture) => kept.report_on(name, &file, picture.as_bytes())?,
                None => kept.without(&format!("submissions/{name}/{file}")),
            }
        }
    }
    Ok(())
}

fn junit_of_all(sheet: &Sheet, file: &mut dyn Write) -> std::io::Result<()> {
    let mut suites = junit::Suites::new(file)?;
    for name in sheet.plan.names() {
        suites.add(&sheet.grade(name).map_err(std::io::Error::other)?, sheet.plan.detail)?;
    }
    suites.finish()
}

fn gradebook(sheet: &Sheet, file: &mut dyn Write) -> std::io::Result<()> {
    let plan = sheet.plan;
    let roster = &plan.roster;
    let words = plan.questions.iter().map(|question| question.slug);
    let words: Vec<&str> = words.filter(|slug| plan.points.of_words(slug) > 0.0).collect();
    let mut book = Gradebook::new(file, &plan.exercises, &words, roster.further())?;
    for name in plan.names() {
        let grade = sheet.grade(name).map_err(std::io::Error::other)?;
        let folder = plan.matches.folder(name).unwrap_or_default();
        book.add(&grade, &plan.folders[name], roster.further_of(folder))?;
    }
    for (folder, student) in &plan.matches.differences.absent {
        book.add_absent(folder, student, roster.further_of(folder))?;
    }
    book.finish()
}

/// What changed, if a finished batch was graded again.
fn regrade(plan: &Plan, kept: &Kept, mut changes: Changes) -> Result<String, Trouble> {
    let Some(former_seed) = kept.former_seed() else {
        kept.without("changes.md");
        return Ok(String::new());
    };
    for former in kept.all_former() {
        if !plan.names().any(|name| *name == former) {
            changes.add_gone(&former);
        }
    }
    kept.report(
        "changes.md",
        changes.markdown(&former_seed.mark(), &kept.seed().mark()).as_bytes(),
    )?;
    Ok(changes.terminal())
}

/// What reports need of the submissions besides their grades, and whose answers in words nobody has read.
fn read_again(
    plan: &Plan,
    judge: &impl Judging,
) -> (Similarity, BTreeMap<String, Words>, BTreeSet<String>) {
    let mut similarity = Similarity::new(&plan.exercises, &repository());
    let (mut words, mut unread) = (BTreeMap::new(), BTreeSet::new());
    for found in &plan.submissions {
        let unknown = |_| Collected { unread: true, ..Collected::default() };
        let collected = calmly(|| judge.collected(found)).unwrap_or_else(Err);
        let collected = collected.unwrap_or_else(unknown);
        let answers = collected.answers;
        let _ = calmly(|| {
            similarity.add(&found.name, |slug| answers.get(slug).map(String::as_str));
        });
        words.insert(found.name.clone(), collected.words);
        if collected.unread {
            unread.insert(found.name.clone());
        }
    }
    (similarity, words, unread)
}

/// What a person has still to do.
fn by_person(sheet: &Sheet, collection: &Collection) -> String {
    let plan = sheet.plan;
    let mut text = String::new();
    if collection.open() > 0 {
        let count = markdown::counted(collection.open(), "answer");
        text += &wrapped(
            &format!(
                "{count} in words without points, which do not count yet: read words.md, and put the rows of \
                 unmarked.csv with points into a file for --marks."
            ),
            "",
        );
    }
    if !collection.unread().is_empty() {
        text += &wrapped(
            &format!(
                "There may be words that were not read, which is no zero: feedback.md says why, and what is not handed \
                 in again is for you to mark in the rows of unmarked.csv. They are those of {}.",
                some(collection.unread())
            ),
            "",
        );
    }
    let known: BTreeSet<String> =
        plan.names().flat_map(|name| plan.called(name)).map(cell).collect();
    let strangers = plan.marks.strangers(|folder| known.contains(folder));
    if !strangers.is_empty() {
        text += &wrapped(
            &format!(
                "No submission has the folder of these marks, so they do not count: {}; write \
                 folders as the column `folder` of gradebook.csv does.",
                some(&strangers)
            ),
            "",
        );
    }
    text
}

/// The first of some names, and how many more there are.
fn some(names: &[String]) -> String {
    const NAMED: usize = 20;
    const LONGEST: usize = 40;
    let mut shown: Vec<String> =
        names.iter().take(NAMED).map(|name| harmless_line(name, LONGEST)).collect();
    if let Some(more) = names.len().checked_sub(NAMED).filter(|more| *more > 0) {
        shown.push(format!("and {more} more"));
    }
    shown.join(", ")
}

/// The grades of a batch, with what persons decided laid over what the grader did.
struct Sheet<'a> {
    plan: &'a Plan,
    kept: &'a Kept,
    words: BTreeMap<String, Words>,
    /// Names of submissions with answers in words that nobody has read.
    unread: BTreeSet<String>,
}

impl Sheet<'_> {
    fn grade(&self, name: &str) -> Result<Grade, Trouble> {
        self.laid_over(name, stored(self.kept, name)?)
    }

    /// The grade of the batch before, with the decisions of today.
    fn former(&self, name: &str) -> Result<Option<Grade>, Trouble> {
        self.kept.former(name).map(|grade| self.laid_over(name, grade)).transpose()
    }

    fn laid_over(&self, name: &str, mut grade: Grade) -> Result<Grade, Trouble> {
        let plan = self.plan;
        let graded = |slug: &str| grade.exercises.iter().any(|it| it.exercise == slug);
        let of_chapters = plan.questions.iter().filter(|question| !graded(question.slug));
        let of_chapters: Vec<ExerciseGrade> = of_chapters.map(ExerciseGrade::in_words).collect();
        grade.exercises.extend(of_chapters);
        let may = |slug: &str| self.may_have_words(name, slug);
        plan.marks.lay_over(&mut grade, &plan.called(name), may, &plan.points);
        // What nobody has marked does not count yet.
        grade.exercises.retain(|it| it.outcome != Outcome::InWords || it.is_marked());
        let row = plan.matches.folder(name).unwrap_or_default();
        let days = plan.roster.days_late(row).map_err(Trouble::Usage)?;
        grade.late = days.map(|days| Late { days, percent: plan.points.taken_off(days) });
        Ok(grade)
    }

    /// Whether a submission has an answer in words, or one that nobody has read.
    fn may_have_words(&self, name: &str, slug: &str) -> bool {
        self.unread.contains(name)
            || self.words.get(name).is_some_and(|words| words.contains_key(slug))
    }

    fn collect(&self, name: &str, grade: &Grade, collection: &mut Collection) {
        let is_open = |slug: &&str| {
            let has = |it: &ExerciseGrade| it.exercise == **slug && it.words.is_some();
            let marked = grade.exercises.iter().any(has);
            self.plan.points.of_words(slug) > 0.0 && self.may_have_words(name, slug) && !marked
        };
        let asked = self.plan.questions.iter().map(|question| question.slug);
        let open: Vec<&str> = asked.filter(is_open).collect();
        if let Some(words) = self.words.get(name) {
            collection.add(&self.plan.folders[name], words, &open);
        }
    }
}

fn stored(kept: &Kept, name: &str) -> Result<Grade, Trouble> {
    kept.grade(name).ok_or_else(|| {
        Trouble::CouldNotGrade(format!(
            "the grade of {name} was kept in {} and cannot be read; run the same command again",
            kept.folder().display()
        ))
    })
}

impl Plan {
    /// By what marks may call a submission: its folder and, where no other one has these, its name and its row of the
    /// roster.
    fn called<'a>(&'a self, name: &'a str) -> Vec<&'a str> {
        let others = [name, self.matches.folder(name).unwrap_or(name)];
        let free = |other: &&str| {
            let other = cell(other);
            !self.folders.values().any(|folder| *folder == other)
        };
        std::iter::once(&*self.folders[name]).chain(others.into_iter().filter(free)).collect()
    }

    fn names(&self) -> impl Iterator<Item = &String> {
        self.submissions.iter().map(|submission| &submission.name)
    }
}

/// A [`Batch`](crate::grade::Batch) whose grades are on disk.
struct Whole<'a> {
    sheet: &'a Sheet<'a>,
    sandbox: &'a str,
}

impl Serialize for Whole<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut batch = serializer.serialize_struct("Batch", 4)?;
        batch.serialize_field("version", &VERSION)?;
        batch.serialize_field("instances", &self.sheet.kept.seed().mark())?;
        batch.serialize_field("sandbox", self.sandbox)?;
        batch.serialize_field("grades", &Grades(self))?;
        batch.end()
    }
}

struct Grades<'a>(&'a Whole<'a>);

impl Serialize for Grades<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let sheet = self.0.sheet;
        let plan = sheet.plan;
        let mut grades = serializer.serialize_seq(Some(plan.submissions.len()))?;
        for name in plan.names() {
            grades.serialize_element(&sheet.grade(name).map_err(S::Error::custom)?)?;
        }
        grades.end()
    }
}
