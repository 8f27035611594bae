//! Grades what was handed in for the flights of an export.

use std::io::Write as _;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::answer::{Answer, NoAnswer};
use super::flights::Graded;
use super::handed::Handed;
use super::judge::{Course, unread};
use super::key::{Exported, Key};
use super::{GRADED_FLIGHT, canary};
use crate::batch::{Finished, Judging, Order, Subject, Trouble, carry_out_on};
use crate::compile;
use crate::grade::{CheckGrade, ExerciseGrade, Grade, Outcome};
use crate::points::Points;
use crate::roster::{Matches, Roster};
use crate::seed::Seed;
use crate::submission::{Collected, Submission};

/// Grades by the key of an export, writes the reports and prints the table.
///
/// # Errors
///
/// A [`Trouble`] when the key or the roster cannot be read, or the grades cannot be kept.
pub fn run(order: &Order, key: &Path) -> Result<Finished, Trouble> {
    let finished = run_quietly(order, key)?;
    // Whoever closes the pipe has read enough.
    let _ = std::io::stdout().write_all(finished.told.as_bytes());
    Ok(finished)
}

/// The same without printing.
///
/// # Errors
///
/// As [`run`].
pub fn run_quietly(order: &Order, key: &Path) -> Result<Finished, Trouble> {
    let exported = Exported::read(key).map_err(Trouble::Usage)?;
    let key = exported.key().map_err(Trouble::Usage)?;
    let seed = Some(Seed::new(u128::from(key.fingerprint())));
    let order = Order { seed, ..order.clone() };
    carry_out_on(&order, Subject::flight(&order)?, |plan, _| {
        let matches = match order.roster {
            Some(_) => plan.matches.clone(),
            None => Roster::of_folders(&exported.folders).matched(&plan.submissions),
        };
        Ok(Pilot { key, exported, matches, points: plan.points.clone() })
    })
}

/// What was handed in, read as an answer, and notices.
type Read = (Result<Answer, NoAnswer>, Vec<String>);

/// Reads it, or says why an archive cannot be looked into: then nobody knows what is in it.
fn read(path: &Path, flights: &[Graded]) -> Result<Read, String> {
    let handed = Handed::find(path)?;
    let folder = handed.folder().ok_or(NoAnswer::Missing);
    Ok((folder.and_then(|folder| Answer::read(&folder, flights)), handed.notices()))
}

/// Flies the flights of whoever handed something in, and judges.
struct Pilot {
    key: Key,
    exported: Exported,
    /// Which folder of the export each submission answers.
    matches: Matches,
    points: Points,
}

impl Pilot {
    /// The flights of a submission.
    fn flights(&self, submission: &Submission) -> Result<Vec<Graded>, String> {
        let folder = self.matches.folder(&submission.name);
        let folder = folder.filter(|folder| self.exported.folders.iter().any(|it| it == folder));
        let folder = folder.ok_or(
            "the export has no flights for this folder: name it as the roster does, or grade with the \
             key of its own export",
        )?;
        Ok(Graded::all(&self.key, folder))
    }

    fn graded(
        &self,
        read: Result<Answer, NoAnswer>,
        flights: Vec<Graded>,
    ) -> Result<ExerciseGrade, String> {
        match read {
            Err(NoAnswer::Missing) => Ok(self.grade_of(Outcome::Missing, Vec::new())),
            Err(why) => Ok(self.grade_of(Outcome::Ran, unread(&why))),
            Ok(answer) => {
                let judged = Course::of(flights)?.judged(&answer)?;
                Ok(self.grade_of(Outcome::Ran, judged.checks()))
            }
        }
    }

    /// Digest of what was read, and of all else that its grade depends on.
    fn key_of(&self, read: &Read) -> String {
        let digest = Sha256::new()
            .chain_update(self.key.fingerprint().to_be_bytes())
            .chain_update(compile::edition())
            .chain_update(format!("{read:?}, {}", self.points.of(GRADED_FLIGHT.slug)))
            .finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    fn grade_of(&self, outcome: Outcome, checks: Vec<CheckGrade>) -> ExerciseGrade {
        ExerciseGrade {
            exercise: GRADED_FLIGHT.slug.to_owned(),
            title: GRADED_FLIGHT.title.to_owned(),
            outcome,
            points: self.points.of(GRADED_FLIGHT.slug),
            checks,
            marked: None,
            words: None,
            comments: Vec::new(),
        }
    }
}

impl Judging for Pilot {
    fn sandbox(&self) -> String {
        "It names the key of the flights, which it does not give away. No code of theirs was run."
            .to_owned()
    }

    fn canaries(&self) -> Result<(), String> {
        canary::sing(&self.key)
    }

    fn key(&self, submission: &Submission) -> Result<String, String> {
        Ok(self.key_of(&read(&submission.path, &self.flights(submission)?)?))
    }

    fn collected(&self, submission: &Submission) -> Result<Collected, String> {
        let handed = Handed::find(&submission.path)?;
        let words = handed.text().0.map(|text| (GRADED_FLIGHT.slug, text)).into_iter().collect();
        Ok(Collected { words, unread: handed.unread(), ..Collected::default() })
    }

    fn grade(&self, submission: &Submission, student: Option<String>) -> Grade {
        let graded = self.flights(submission).and_then(|flights| {
            let read = read(&submission.path, &flights)?;
            Ok((self.key_of(&read), read.1, self.graded(read.0, flights)))
        });
        let (key, notices, graded) =
            graded.unwrap_or_else(|why| (String::new(), Vec::new(), Err(why)));
        let graded =
            graded.unwrap_or_else(|why| self.grade_of(Outcome::CouldNotGrade(why), Vec::new()));
        Grade {
            submission: submission.name.clone(),
            student,
            key,
            notices,
            late: None,
            exercises: vec![graded],
        }
    }
}
