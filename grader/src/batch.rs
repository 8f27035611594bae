//! Grades submissions by the hundred: one queue, a few threads, and every grade kept on disk as
//! soon as it is there.

mod kept;
mod publish;

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write as _;
use std::num::NonZero;
use std::panic::{self, AssertUnwindSafe};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, Once, OnceLock};
use std::thread;

use exercise_spec::{EXERCISES, Exercise, Question, exercise};
use indicatif::{ProgressBar, ProgressStyle};
use thiserror::Error;

use crate::fly::GRADED_FLIGHT;
use crate::fly::handed::has_flights;
use crate::grade::{ExerciseGrade, Grade, Outcome};
use crate::judge::Judge;
use crate::marks::Marks;
use crate::memory::Memory;
use crate::points::{Points, unknown};
use crate::report::Detail;
use crate::report::gradebook::cell;
use crate::repository;
use crate::roster::{Matches, Roster};
use crate::seed::Seed;
use crate::submission::{self, Collected, Holds, Submission, has_answers};
use crate::text::harmless;
use crate::words;
use kept::Kept;

/// Why a submission is passed over at which an earlier run came to its end.
const ENDED: &str = "an earlier run of the grader was ended, from outside or for want of memory, while it was at this \
                     submission. It is passed over this time, so that nobody waits behind it; run the same command \
                     once more to try it again";

/// What is to be graded, and how.
#[derive(Debug, Clone)]
pub struct Order {
    /// Submissions, or folders of submissions.
    pub submissions: Vec<PathBuf>,
    /// Whether each of these paths is one submission, whatever it holds.
    pub single: bool,
    /// Slugs of the exercises to grade; all when there is none.
    pub exercises: Vec<String>,
    /// Seed of the hidden instances.
    pub seed: Option<Seed>,
    /// What students are told about hidden checks.
    pub detail: Detail,
    /// Where reports go.
    pub out: PathBuf,
    /// A CSV file of folders and names.
    pub roster: Option<PathBuf>,
    /// A file of points and weights.
    pub points: Option<PathBuf>,
    /// A file of what a person decides.
    pub marks: Option<PathBuf>,
    /// How many submissions at a time.
    pub jobs: Option<usize>,
    /// Megabytes that grading may use; what the container allows when there is none.
    pub memory: Option<u64>,
}

/// Why there are no grades.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Trouble {
    /// The order cannot be carried out as it stands.
    #[error("{0}")]
    Usage(String),
    /// The grader failed.
    #[error("{0}")]
    CouldNotGrade(String),
}

/// What gives a submission its grade. The grader's is [`Judge`]; tests have simpler ones.
pub trait Judging: Sync {
    /// What stands around the compiler, in a sentence.
    fn sandbox(&self) -> String;

    /// Grades answers that are known to be right and wrong.
    ///
    /// # Errors
    ///
    /// A sentence when one of them comes out otherwise.
    fn canaries(&self) -> Result<(), String>;

    /// Digest of all that a grade depends on.
    ///
    /// # Errors
    ///
    /// A sentence when the submission cannot be read.
    fn key(&self, submission: &Submission) -> Result<String, String>;

    /// Grades a submission.
    fn grade(&self, submission: &Submission, student: Option<String>) -> Grade;

    /// What reports need of a submission besides its grade.
    ///
    /// # Errors
    ///
    /// A sentence when it cannot be read.
    fn collected(&self, submission: &Submission) -> Result<Collected, String> {
        submission::collect(submission)
    }
}

impl Judging for Judge {
    fn sandbox(&self) -> String {
        Self::sandbox(self)
    }

    fn canaries(&self) -> Result<(), String> {
        Self::canaries(self)
    }

    fn key(&self, submission: &Submission) -> Result<String, String> {
        submission::collect(submission).map(|collected| Self::key(self, &collected))
    }

    fn grade(&self, submission: &Submission, student: Option<String>) -> Grade {
        Self::grade(self, submission, student)
    }
}

/// A batch that was graded and reported.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finished {
    /// The seed of the hidden instances.
    pub seed: Seed,
    /// How many submissions have a grade.
    pub graded: usize,
    /// How many have none, because something could not be graded.
    pub ungraded: usize,
    /// What the terminal shows.
    pub told: String,
}

/// Grades, writes the reports and prints the table. The grades stay on disk, so that hundreds of
/// them need no more memory than one.
///
/// # Errors
///
/// A [`Trouble`] when the order cannot be carried out, the canaries come out wrong, or the grades
/// cannot be kept.
pub fn carry_out(order: &Order) -> Result<Finished, Trouble> {
    let memory = Memory::of(order.memory).map_err(Trouble::Usage)?;
    let finished = carry_out_with(order, |points, seed, exercises| {
        Judge::prepare(points, seed, exercises, memory)
    })?;
    // Whoever closes the pipe has read enough.
    let _ = std::io::stdout().write_all(finished.told.as_bytes());
    Ok(finished)
}

/// The same with any judge, and without printing.
///
/// # Errors
///
/// As [`carry_out`].
pub fn carry_out_with<J: Judging>(
    order: &Order,
    prepare: impl FnOnce(Points, Seed, &[&'static Exercise]) -> Result<J, String>,
) -> Result<Finished, Trouble> {
    carry_out_on(order, Subject::of(order)?, |plan, seed| {
        prepare(plan.points.clone(), seed, &plan.exercises)
    })
}

/// What submissions are about.
pub(crate) struct Subject {
    /// In the order of the reports.
    exercises: Vec<&'static Exercise>,
    /// What is asked in words: by these exercises and, unless an order names some of them, by chapters.
    questions: Vec<Question>,
    /// What these are worth.
    points: Points,
    /// Whether a folder has something of an answer.
    holds: Holds,
}

impl Subject {
    /// The exercises of the book that an order names.
    fn of(order: &Order) -> Result<Self, Trouble> {
        let mut exercises = exercises(&order.exercises).map_err(Trouble::Usage)?;
        let points = points_of(order).map_err(Trouble::Usage)?;
        if order.exercises.is_empty() {
            // What is worth nothing is no part of the course.
            exercises.retain(|exercise| points.of(exercise.slug) > 0.0);
        }
        if exercises.is_empty() {
            let sentence = "no exercise is worth anything; give one of them points";
            return Err(Trouble::Usage(sentence.to_owned()));
        }
        let mut questions = words::asked();
        questions.retain(|question| match exercise(question.slug) {
            Some(asks) => exercises.iter().any(|exercise| exercise.slug == asks.slug),
            None => order.exercises.is_empty(),
        });
        Ok(Self { exercises, questions, points, holds: has_answers })
    }

    /// The graded flight, at what a file of points says.
    ///
    /// # Errors
    ///
    /// A [`Trouble`] when the file cannot be read, or gives it no points.
    pub(crate) fn flight(order: &Order) -> Result<Self, Trouble> {
        let points = points_of(order).map_err(Trouble::Usage)?;
        let slug = GRADED_FLIGHT.slug;
        if points.of(slug) == 0.0 {
            let sentence = format!(
                "the file of points gives `{slug}` none; write `{slug} = 100` below [points]"
            );
            return Err(Trouble::Usage(sentence));
        }
        let questions = vec![GRADED_FLIGHT.question()];
        Ok(Self { exercises: vec![&GRADED_FLIGHT], questions, points, holds: has_flights })
    }
}

/// The same about something else than exercises of the book.
///
/// # Errors
///
/// As [`carry_out`].
pub(crate) fn carry_out_on<J: Judging>(
    order: &Order,
    subject: Subject,
    prepare: impl FnOnce(&Plan, Seed) -> Result<J, String>,
) -> Result<Finished, Trouble> {
    let plan = Plan::of(order, subject)?;
    let mut kept = Kept::open(&order.out, order.seed, &plan.slugs())?;
    let judge = prepare(&plan, kept.seed()).map_err(Trouble::CouldNotGrade)?;
    let canaries = Canaries::default();
    thread::scope(|scope| {
        scope.spawn(|| canaries.sing(&judge, &kept));
        plan.grade(&judge, &kept, &canaries)
    })?;
    let finished = publish::publish(&plan, &kept, &judge)?;
    kept.finish()?;
    Ok(finished)
}

/// Answers that are known to be right and wrong. They are graded beside the first submissions, and
/// until they have come out as they must, no grade is kept.
#[derive(Default)]
struct Canaries(OnceLock<Result<(), Trouble>>);

impl Canaries {
    /// Grades them, and begins the batch when they come out right.
    fn sing(&self, judge: &impl Judging, kept: &Kept) {
        let graded = calmly(|| judge.canaries()).unwrap_or_else(Err);
        let nothing = |error| {
            Trouble::CouldNotGrade(format!("nothing is graded and nothing published: {error}"))
        };
        let _ = self.0.set(graded.map_err(nothing).and_then(|()| kept.begin()));
    }

    /// Waits until they have come out.
    fn wait(&self) -> Result<(), Trouble> {
        self.0.wait().clone()
    }
}

/// An order whose files were read.
pub(crate) struct Plan {
    /// By name.
    pub submissions: Vec<Submission>,
    /// What tables and marks call each, by its name.
    folders: BTreeMap<String, String>,
    exercises: Vec<&'static Exercise>,
    questions: Vec<Question>,
    /// What the exercises are worth.
    pub points: Points,
    roster: Roster,
    /// The rows of the roster, if the order has one.
    pub matches: Matches,
    detail: Detail,
    marks: Marks,
    jobs: usize,
    /// How many submissions had their grade already.
    had: AtomicUsize,
}

impl Plan {
    fn of(order: &Order, subject: Subject) -> Result<Self, Trouble> {
        let Subject { exercises, questions, points, holds } = subject;
        let roster = order.roster.as_deref().map(Roster::read).transpose();
        let jobs = order.jobs.map_or_else(cores, |jobs| {
            if jobs == 0 {
                Err("--jobs 0 grades nothing; leave it out".to_owned())
            } else {
                Ok(jobs)
            }
        });
        let roster = roster.map_err(Trouble::Usage)?;
        let submissions = submissions(order, holds).map_err(Trouble::Usage)?;
        let marks = order.marks.as_deref().map(|path| Marks::read(path, &points)).transpose();
        let matches = roster.as_ref().map(|roster| roster.matched(&submissions));
        Ok(Self {
            folders: folders(&submissions),
            submissions,
            exercises,
            questions,
            points,
            roster: roster.unwrap_or_default(),
            matches: matches.unwrap_or_default(),
            detail: order.detail,
            marks: marks.map_err(Trouble::Usage)?.unwrap_or_default(),
            jobs: jobs.map_err(Trouble::Usage)?,
            had: AtomicUsize::new(0),
        })
    }

    fn slugs(&self) -> Vec<&'static str> {
        self.exercises.iter().map(|exercise| exercise.slug).collect()
    }

    /// Grades what has no grade yet.
    fn grade(&self, judge: &impl Judging, kept: &Kept, canaries: &Canaries) -> Result<(), Trouble> {
        let next = AtomicUsize::new(0);
        let trouble = Mutex::new(None);
        let bar = bar(self.submissions.len());
        // What could not be graded before comes last, so that nobody waits behind it.
        let open =
            |it: &&Submission| kept.grade(&it.name).is_some_and(|grade| grade.earned().is_none());
        let (last, mut queue): (Vec<_>, Vec<_>) = self.submissions.iter().partition(open);
        queue.extend(last);
        let work = || {
            while let Some(submission) = queue.get(next.fetch_add(1, Ordering::Relaxed)) {
                if let Err(error) = self.grade_one(judge, kept, canaries, submission) {
                    next.store(self.submissions.len(), Ordering::Relaxed);
                    trouble.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).replace(error);
                }
                bar.inc(1);
            }
        };
        thread::scope(|scope| {
            for _ in 0..self.jobs.min(self.submissions.len()) {
                scope.spawn(work);
            }
        });
        bar.finish_and_clear();
        canaries.wait()?;
        trouble.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()).map_or(Ok(()), Err)
    }

    /// Grades one submission, unless it has the grade of these very answers already. What could
    /// not be graded is tried again.
    fn grade_one(
        &self,
        judge: &impl Judging,
        kept: &Kept,
        canaries: &Canaries,
        submission: &Submission,
    ) -> Result<(), Trouble> {
        let student = self.roster.student(&self.matches, &submission.name);
        let student = student.map(str::to_owned);
        let former = kept.grade(&submission.name).filter(|grade| grade.earned().is_some());
        let key = calmly(|| judge.key(submission)).ok().and_then(Result::ok);
        if let Some(former) = former.filter(|grade| Some(&grade.key) == key.as_ref()) {
            self.had.fetch_add(1, Ordering::Relaxed);
            if former.student == student {
                return Ok(());
            }
            canaries.wait()?;
            return kept.keep(&Grade { student, ..former });
        }
        let key = key.unwrap_or_default();
        let grade = if kept.ended_at(&submission.name, &key) {
            self.ungraded(submission, student, ENDED)
        } else {
            kept.begin_at(&submission.name, &key)?;
            let grade = calmly(|| judge.grade(submission, student.clone()));
            let why = |panic| format!("the grader panicked: {panic}");
            grade.unwrap_or_else(|panic| self.ungraded(submission, student, &why(panic)))
        };
        let kept_or_not = canaries.wait().and_then(|()| {
            kept.keep(&Grade { submission: submission.name.clone(), ..readable(grade) })
        });
        kept.done_with(&submission.name);
        kept_or_not
    }

    /// The grade of a submission at which the grader itself failed.
    fn ungraded(&self, submission: &Submission, student: Option<String>, why: &str) -> Grade {
        let exercise = |exercise: &&'static Exercise| ExerciseGrade {
            exercise: exercise.slug.to_owned(),
            title: exercise.title.to_owned(),
            outcome: Outcome::CouldNotGrade(why.to_owned()),
            points: self.points.of(exercise.slug),
            checks: Vec::new(),
            marked: None,
            words: None,
            comments: Vec::new(),
        };
        Grade {
            submission: submission.name.clone(),
            student,
            key: String::new(),
            notices: Vec::new(),
            late: None,
            exercises: self.exercises.iter().map(exercise).collect(),
        }
    }
}

fn points_of(order: &Order) -> Result<Points, String> {
    match &order.points {
        Some(path) => Points::read(path),
        None => Points::read(&repository().join("grader").join("points.toml")),
    }
}

/// The exercises of an order, in the order of the book.
fn exercises(slugs: &[String]) -> Result<Vec<&'static Exercise>, String> {
    if let Some(slug) = slugs.iter().find(|slug| exercise(slug).is_none()) {
        return Err(unknown(&harmless(slug, 60)));
    }
    let asked = |exercise: &&&'static Exercise| {
        slugs.is_empty() || slugs.iter().any(|slug| slug == exercise.slug)
    };
    Ok(EXERCISES.iter().filter(asked).copied().collect())
}

/// The submissions of an order, by name. The folder of the grades may lie among them.
fn submissions(order: &Order, holds: Holds) -> Result<Vec<Submission>, String> {
    let mut found = match order.single {
        true => submission::single(&order.submissions)?,
        false => submission::find(&order.submissions, holds)?,
    };
    if let Ok(out) = order.out.canonicalize() {
        found.retain(|submission| submission.path.canonicalize().ok().as_ref() != Some(&out));
    }
    if found.is_empty() {
        return Err("there is no submission to grade; name a folder that holds some".to_owned());
    }
    Ok(found)
}

/// What tables and marks call submissions: each by its folder, or by its own name where another folder is called
/// the same, and with a number where that is taken, too.
fn folders(submissions: &[Submission]) -> BTreeMap<String, String> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    for submission in submissions {
        *count.entry(cell(&submission.folder())).or_default() += 1;
    }
    let mut taken: BTreeSet<String> = count.keys().filter(|it| count[*it] == 1).cloned().collect();
    let mut called = |it: &Submission| {
        let (folder, name) = (cell(&it.folder()), cell(&it.name));
        if count[&folder] == 1 {
            return folder;
        }
        let mut free = name.clone();
        let mut number = 2;
        while !taken.insert(free.clone()) {
            free = format!("{name}-{number}");
            number += 1;
        }
        free
    };
    submissions.iter().map(|it| (it.name.clone(), called(it))).collect()
}

fn cores() -> Result<usize, String> {
    Ok(thread::available_parallelism().map_or(1, NonZero::get))
}

fn bar(length: usize) -> ProgressBar {
    let form = "{bar:40} {pos} of {len} submissions, {eta} left";
    let style = ProgressStyle::with_template(form);
    // Nothing is drawn where nobody looks: indicatif asks whether it is a terminal.
    ProgressBar::new(length as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

thread_local! {
    static CALM: Cell<bool> = const { Cell::new(false) };
    /// What the latest panic says and where it happened.
    static SAID: Cell<Option<String>> = const { Cell::new(None) };
}

/// Calls something that must not panic. When it does, the terminal is spared, and what the panic
/// says comes back.
fn calmly<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if CALM.get() {
                let said = info.payload_as_str().unwrap_or("without words");
                let place = info.location().map(|at| format!(" at {}:{}", at.file(), at.line()));
                SAID.set(Some(format!("{said}{}", place.unwrap_or_default())));
            } else {
                before(info);
            }
        }));
    });
    CALM.set(true);
    let outcome = panic::catch_unwind(AssertUnwindSafe(call));
    CALM.set(false);
    outcome.map_err(|_| SAID.take().unwrap_or_default())
}

/// The grade with every text harmless and of a length that can be kept and read.
fn readable(mut grade: Grade) -> Grade {
    const LINE: usize = 2_000;
    const PAGE: usize = 10_000;
    let shorten = |text: &mut String, most: usize| *text = harmless(text, most);
    grade.notices.truncate(100);
    grade.notices.iter_mut().for_each(|notice| shorten(notice, LINE));
    for exercise in &mut grade.exercises {
        match &mut exercise.outcome {
            Outcome::Ran | Outcome::Missing | Outcome::NotBegun | Outcome::InWords => {}
            Outcome::Refused(why) | Outcome::DoesNotCompile(why) | Outcome::CouldNotGrade(why) => {
                shorten(why, PAGE);
            }
        }
        for check in &mut exercise.checks {
            shorten(&mut check.sentence, LINE);
            shorten(&mut check.numbers, PAGE);
        }
    }
    grade
}
