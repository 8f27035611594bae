//! Writes every report of a batch, grade by grade.

use std::io::Write;
use std::sync::atomic::Ordering;

use serde::ser::{Error as _, SerializeSeq, SerializeStruct};
use serde::{Serialize, Serializer};

use super::kept::Kept;
use super::{Finished, Plan, Trouble};
use crate::changes::Changes;
use crate::grade::{Grade, VERSION};
use crate::items::Items;
use crate::report::gradebook::Gradebook;
use crate::report::markdown::{self, Summary};
use crate::report::terminal::{Terminal, wrapped};
use crate::report::{gradescope, junit};
use crate::repository;
use crate::similarity::Similarity;
use crate::submission;

/// Writes every report, and hands back what the terminal shows.
pub fn publish(plan: &Plan, kept: &Kept, sandbox: &str) -> Result<Finished, Trouble> {
    let seed = kept.seed();
    let mark = seed.mark();
    let differences = &plan.matches.differences;
    let mut terminal = Terminal::new(&plan.exercises);
    let mut summary = Summary::new(&plan.exercises);
    let mut items = Items::new(&plan.exercises);
    let mut changes = Changes::default();
    let mut ungraded = 0;
    let mut alone = String::new();
    for name in plan.names() {
        let grade = stored(kept, name)?;
        one(plan, kept, &grade)?;
        terminal.add(&grade);
        summary.add(&grade);
        items.add(&grade);
        changes.add(kept.former(name).as_ref(), &grade);
        ungraded += usize::from(grade.earned().is_none());
        if plan.submissions.len() == 1 {
            alone = format!("\n{}", markdown::feedback(&grade, plan.detail));
        }
    }
    let whole = Whole { plan, kept, sandbox };
    kept.report_by("grade.json", |file| {
        serde_json::to_writer_pretty(file, &whole).map_err(std::io::Error::from)
    })?;
    kept.report_by("gradebook.csv", |file| gradebook(plan, kept, file))?;
    kept.report_by("junit.xml", |file| junit_of_all(plan, kept, file))?;
    kept.report("items.md", items.markdown().as_bytes())?;
    kept.report("similarity.md", similarity(plan).markdown().as_bytes())?;
    let summary = summary.finish(&mark, sandbox, differences) + &alone;
    kept.report("summary.md", summary.as_bytes())?;
    let mut told = terminal.finish(&mark, sandbox, differences);
    told += &had(plan, kept);
    told += &regrade(plan, kept, changes)?;
    told += &wrapped(
        &format!(
            "Reports in {}: summary.md, gradebook.csv, junit.xml, items.md, similarity.md, \
             grade.json, and for each submission feedback.md, results.json and junit.xml.",
            kept.folder().display()
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
    kept.report_on(name, "junit.xml", junit.as_bytes())
}

fn junit_of_all(plan: &Plan, kept: &Kept, file: &mut dyn Write) -> std::io::Result<()> {
    let mut suites = junit::Suites::new(file)?;
    for name in plan.names() {
        suites.add(&stored(kept, name).map_err(std::io::Error::other)?, plan.detail)?;
    }
    suites.finish()
}

fn gradebook(plan: &Plan, kept: &Kept, file: &mut dyn Write) -> std::io::Result<()> {
    let roster = &plan.roster;
    let mut book = Gradebook::new(file, &plan.exercises, roster.further())?;
    for name in plan.names() {
        let grade = stored(kept, name).map_err(std::io::Error::other)?;
        let folder = plan.matches.folder(name).unwrap_or_default();
        book.add(&grade, &plan.handed_in(name), roster.further_of(folder))?;
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

fn similarity(plan: &Plan) -> Similarity {
    let mut similarity = Similarity::new(&plan.exercises, &repository());
    for found in &plan.submissions {
        // What could not be read has no grade either, and is told there.
        let answers = submission::collect(found).map(|collected| collected.answers);
        let answers = answers.unwrap_or_default();
        similarity.add(&found.name, |slug| answers.get(slug).map(String::as_str));
    }
    similarity
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
    /// What the folder of a submission is called.
    fn handed_in(&self, name: &str) -> String {
        let found = self.submissions.iter().find(|submission| submission.name == name);
        let folder = found.and_then(|submission| submission.path.file_name());
        folder.unwrap_or_default().to_string_lossy().into_owned()
    }

    fn names(&self) -> impl Iterator<Item = &String> {
        self.submissions.iter().map(|submission| &submission.name)
    }
}

/// A [`Batch`](crate::grade::Batch) whose grades are on disk.
struct Whole<'a> {
    plan: &'a Plan,
    kept: &'a Kept,
    sandbox: &'a str,
}

impl Serialize for Whole<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut batch = serializer.serialize_struct("Batch", 4)?;
        batch.serialize_field("version", &VERSION)?;
        batch.serialize_field("instances", &self.kept.seed().mark())?;
        batch.serialize_field("sandbox", self.sandbox)?;
        batch.serialize_field("grades", &Grades(self))?;
        batch.end()
    }
}

struct Grades<'a>(&'a Whole<'a>);

impl Serialize for Grades<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Whole { plan, kept, .. } = self.0;
        let mut grades = serializer.serialize_seq(Some(plan.submissions.len()))?;
        for name in plan.names() {
            grades.serialize_element(&stored(kept, name).map_err(S::Error::custom)?)?;
        }
        grades.end()
    }
}
