//! Grades what was handed in for the flights of an export.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use exercise_spec::Exercise;
use sha2::{Digest, Sha256};

use super::answer::{Answer, NoAnswer};
use super::flights::Graded;
use super::judge::{Course, unread};
use super::key::{Exported, Key};
use crate::batch::{Finished, Judging, Order, Subject, Trouble, carry_out_on};
use crate::grade::{CheckGrade, ExerciseGrade, Grade, Outcome};
use crate::points::Points;
use crate::report::Detail;
use crate::roster::Roster;
use crate::seed::Seed;
use crate::submission::{self, Submission};

/// The graded flight among the exercises.
pub static EXERCISE: Exercise = Exercise {
    slug: "graded_flight",
    title: "A graded flight",
    chapter: "odometry",
    functions: &[],
    misconceptions: &[],
    types: &[],
    forbidden: &[],
    hints: "",
    checks: Vec::new,
};

/// What it is worth.
pub const POINTS: f64 = 100.0;

/// What is to be graded, and how.
#[derive(Debug, Clone)]
pub struct FlyOrder {
    /// Submissions, or folders of submissions.
    pub submissions: Vec<PathBuf>,
    /// Whether each of these paths is one submission, whatever it holds.
    pub single: bool,
    /// The key of the export.
    pub key: PathBuf,
    /// A CSV file of folders and names.
    pub roster: Option<PathBuf>,
    /// What students are told about hidden checks.
    pub detail: Detail,
    /// Where reports go.
    pub out: PathBuf,
    /// How many submissions at a time.
    pub jobs: Option<usize>,
}

/// Grades, writes the reports and prints the table.
///
/// # Errors
///
/// A [`Trouble`] when the key or the roster cannot be read, or the grades cannot be kept.
pub fn run(order: &FlyOrder) -> Result<Finished, Trouble> {
    let finished = run_quietly(order)?;
    // Whoever closes the pipe has read enough.
    let _ = std::io::stdout().write_all(finished.told.as_bytes());
    Ok(finished)
}

/// The same without printing.
///
/// # Errors
///
/// As [`run`].
pub fn run_quietly(order: &FlyOrder) -> Result<Finished, Trouble> {
    let exported = Exported::read(&order.key).map_err(Trouble::Usage)?;
    let key = exported.key().map_err(Trouble::Usage)?;
    let batch = Order {
        submissions: order.submissions.clone(),
        single: order.single,
        exercises: Vec::new(),
        seed: Some(Seed::new(u128::from(key.fingerprint()))),
        detail: order.detail,
        out: order.out.clone(),
        roster: order.roster.clone(),
        points: None,
        marks: None,
        jobs: order.jobs,
        memory: None,
    };
    let folders = folders(order, &exported).map_err(Trouble::Usage)?;
    let points = Points::of_one(EXERCISE.slug, POINTS);
    let subject = Subject { exercises: vec![&EXERCISE], points };
    carry_out_on(&batch, subject, |_, _, _| Ok(Pilot { key, exported, folders }))
}

/// The folder of the export that each submission answers, by its name.
fn folders(order: &FlyOrder, exported: &Exported) -> Result<BTreeMap<String, String>, String> {
    let found = match order.single {
        true => submission::single(&order.submissions)?,
        false => submission::find(&order.submissions)?,
    };
    let roster = match &order.roster {
        Some(path) => Roster::read(path)?,
        None => Roster::of_folders(&exported.folders),
    };
    let matches = roster.matched(&found);
    let folder = |it: &Submission| Some((it.name.clone(), matches.folder(&it.name)?.to_owned()));
    Ok(found.iter().filter_map(folder).collect())
}

/// Flies the flights of whoever handed something in, and judges.
struct Pilot {
    key: Key,
    exported: Exported,
    /// Folders of the export by names of submissions.
    folders: BTreeMap<String, String>,
}

impl Pilot {
    /// The flights of a submission.
    fn flights(&self, submission: &Submission) -> Result<Vec<Graded>, String> {
        let folder = self.folders.get(&submission.name);
        let folder = folder.filter(|folder| self.exported.folders.contains(folder));
        let folder = folder.ok_or(
            "the export has no flights for this folder: name it as the roster does, or grade with the \
             key of its own export",
        )?;
        Ok(Graded::all(&self.key, folder))
    }

    fn graded(&self, root: &Path, flights: Vec<Graded>) -> Result<ExerciseGrade, String> {
        match Answer::read(root, &flights) {
            Err(NoAnswer::Missing) => Ok(grade_of(Outcome::Missing, Vec::new())),
            Err(why) => Ok(grade_of(Outcome::Ran, unread(&why))),
            Ok(answer) => {
                let judged = Course::of(flights)?.judged(&answer)?;
                Ok(grade_of(Outcome::Ran, judged.checks()))
            }
        }
    }
}

fn grade_of(outcome: Outcome, checks: Vec<CheckGrade>) -> ExerciseGrade {
    ExerciseGrade {
        exercise: EXERCISE.slug.to_owned(),
        title: EXERCISE.title.to_owned(),
        outcome,
        points: POINTS,
        checks,
        marked: None,
        words: None,
        comments: Vec::new(),
    }
}

impl Judging for Pilot {
    fn sandbox(&self) -> String {
        "It names the key of the flights, which it does not give away. No code of theirs was run."
            .to_owned()
    }

    fn canaries(&self) -> Result<(), String> {
        Ok(())
    }

    fn key(&self, submission: &Submission) -> Result<String, String> {
        let read = Answer::read(&submission.path, &self.flights(submission)?);
        let digest = Sha256::new()
            .chain_update(self.key.fingerprint().to_be_bytes())
            .chain_update(env!("CARGO_PKG_VERSION"))
            .chain_update(format!("{read:?}"))
            .finalize();
        Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
    }

    fn grade(&self, submission: &Submission, student: Option<String>) -> Grade {
        let graded = self
            .flights(submission)
            .and_then(|flights| self.graded(&submission.path, flights))
            .unwrap_or_else(|why| grade_of(Outcome::CouldNotGrade(why), Vec::new()));
        Grade {
            submission: submission.name.clone(),
            student,
            key: Judging::key(self, submission).unwrap_or_default(),
            notices: Vec::new(),
            late: None,
            exercises: vec![graded],
        }
    }
}
