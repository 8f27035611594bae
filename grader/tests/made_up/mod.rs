//! Grades that nobody earned, and a judge that needs no compiler.
#![allow(dead_code, reason = "each test file uses its part")]

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use exercise_spec::{EXERCISES, Exercise};
use grader::batch::{Judging, Order};
use grader::grade::{CheckGrade, ExerciseGrade, Grade, Outcome, Verdict};
use grader::points::Points;
use grader::report::Detail;
use grader::seed::Seed;
use grader::submission::{Collected, Submission, collect};

/// Names and sentences as somebody might hand them in who wishes a report ill.
pub const HOSTILE: &[&str] = &[
    "\u{1b}[31mred\u{1b}[0m \u{1b}]0;title\u{7} \u{9b}2J",
    "a|b | c ||",
    "<script>alert(1)</script><img src=x onerror=alert(1)>",
    "`code` ``` ```` ~~~",
    "=cmd|'/c calc'!A1",
    "+1",
    "-2+3",
    "@SUM(A1)",
    "\t=1",
    "]]> <![CDATA[ </failure></testcase>",
    "&amp; &lt; &#x1b; \u{0} \u{1} \u{b} \u{fffe}\u{ffff}",
    "line\nfeed\r\nand \r more",
    "# heading\n- item\n1. one\n> quote\n---",
    "[link](javascript:alert(1)) ![](https://example.org/x.png) www.example.org https://example.org",
    "\u{202e}evil\u{202c} \u{200b}zero \u{feff}",
    "\"quote\", and 'more', \\ back",
    "$x$ $$y$$ @somebody #1 :smile:",
    "{\"score\": 100}",
    "../../../etc/passwd",
    "e\u{301}\u{302}\u{303}\u{304} 漢字 \u{1f600}",
];

pub fn check(name: &str, hidden: bool, verdict: Verdict) -> CheckGrade {
    let failed = verdict == Verdict::Failed;
    CheckGrade {
        name: name.to_owned(),
        hidden,
        weight: 1.0,
        verdict,
        sentence: if failed {
            "The sign is wrong: which way does it go?".to_owned()
        } else {
            String::new()
        },
        quiet: None,
        numbers: if failed {
            "expected:\n  [0]   1.0\nobtained:\n  [0]  -1.0*".to_owned()
        } else {
            String::new()
        },
        misconception: failed.then(|| "skew_sign".to_owned()),
        picture: None,
    }
}

/// An exercise of ten points by its number in the book.
pub fn exercise(index: usize, outcome: Outcome, checks: Vec<CheckGrade>) -> ExerciseGrade {
    let Exercise { slug, title, .. } = EXERCISES[index];
    let (exercise, title) = ((*slug).to_owned(), (*title).to_owned());
    ExerciseGrade {
        exercise,
        title,
        outcome,
        points: 10.0,
        checks,
        marked: None,
        words: None,
        comments: Vec::new(),
    }
}

pub fn grade(submission: &str, exercises: Vec<ExerciseGrade>) -> Grade {
    Grade {
        submission: submission.to_owned(),
        student: None,
        key: "key".to_owned(),
        notices: Vec::new(),
        late: None,
        exercises,
    }
}

/// One exercise of each kind: solved, solved in part, missing, refused, without form, and two
/// that could not be graded.
pub fn every_kind(submission: &str) -> Grade {
    use Verdict::{CouldNotGrade, Failed, Passed};
    let why = || "a sentence with a reason".to_owned();
    grade(
        submission,
        vec![
            exercise(0, Outcome::Ran, vec![check("a", false, Passed), check("b", true, Passed)]),
            exercise(
                1,
                Outcome::Ran,
                vec![check("a", false, Failed), check("b", true, Failed), check("c", true, Passed)],
            ),
            exercise(2, Outcome::Missing, vec![]),
            exercise(3, Outcome::Refused(why()), vec![]),
            exercise(
                4,
                Outcome::DoesNotCompile("error[E0308]: mismatched types".to_owned()),
                vec![],
            ),
            exercise(5, Outcome::CouldNotGrade("there is no compiler".to_owned()), vec![]),
            exercise(
                6,
                Outcome::Ran,
                vec![check("a", false, Passed), check("b", true, CouldNotGrade)],
            ),
        ],
    )
}

/// The same without what could not be graded.
pub fn every_kind_graded(submission: &str) -> Grade {
    let mut grade = every_kind(submission);
    grade.exercises.retain(|exercise| exercise.earned().is_some());
    grade
}

/// A grade whose every text is `text`.
pub fn hostile(text: &str) -> Grade {
    let mut grade = every_kind(text);
    grade.student = Some(text.to_owned());
    grade.notices = vec![text.to_owned(); 3];
    for exercise in &mut grade.exercises {
        match &mut exercise.outcome {
            Outcome::Refused(why) | Outcome::DoesNotCompile(why) | Outcome::CouldNotGrade(why) => {
                *why = text.to_owned();
            }
            Outcome::Ran | Outcome::Missing | Outcome::NotBegun | Outcome::InWords => {}
        }
        for check in &mut exercise.checks {
            check.sentence = text.to_owned();
            check.numbers = format!("{text}\n{text}");
        }
    }
    grade
}

/// The seed of orders.
pub const SEED: Seed = Seed::new(7);

/// Folders of submissions, each with one answer.
pub fn submissions(folder: &Path, answers: &[(&str, &str)]) -> PathBuf {
    let path = folder.join("submissions");
    for (name, answer) in answers {
        hand_in(&path, name, answer);
    }
    path
}

pub fn hand_in(submissions: &Path, name: &str, answer: &str) {
    let folder = submissions.join(name).join("exercises/src");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join(format!("{}.rs", EXERCISES[0].slug)), answer).expect("an answer");
}

pub fn order(submissions: &Path, out: &Path) -> Order {
    Order {
        submissions: vec![submissions.to_owned()],
        single: false,
        exercises: vec![EXERCISES[0].slug.to_owned(), EXERCISES[1].slug.to_owned()],
        seed: Some(SEED),
        detail: Detail::Hint,
        out: out.to_owned(),
        roster: None,
        marks: None,
        points: None,
        jobs: Some(2),
        memory: None,
    }
}

/// A judge that rolls dice by the answer and the seed, and does what the answer asks it to:
/// `panic`, `cannot`, `abort`, or `later` to panic when it is read again.
pub struct StandIn {
    pub seed: Seed,
    pub points: Points,
    pub exercises: Vec<&'static Exercise>,
    pub canaries: Result<(), String>,
    /// How many submissions it graded.
    pub graded: &'static AtomicUsize,
    /// Where it writes the name of each submission it grades.
    pub log: Option<PathBuf>,
    /// After how many submissions it ends the process.
    pub last: usize,
}

impl StandIn {
    pub fn new(points: Points, seed: Seed, exercises: &[&'static Exercise]) -> Self {
        Self {
            seed,
            points,
            exercises: exercises.to_vec(),
            canaries: Ok(()),
            graded: Box::leak(Box::new(AtomicUsize::new(0))),
            log: None,
            last: usize::MAX,
        }
    }

    fn answer(submission: &Submission) -> Result<String, String> {
        let collected = collect(submission)?;
        Ok(collected.answers.get(EXERCISES[0].slug).cloned().unwrap_or_default())
    }

    fn dice(&self, answer: &str, exercise: &str, name: &str) -> Verdict {
        let mut hasher = DefaultHasher::new();
        (self.seed, answer, exercise, name).hash(&mut hasher);
        match (answer, hasher.finish() % 2) {
            ("right", _) => Verdict::Passed,
            ("cannot", _) => Verdict::CouldNotGrade,
            (_, 0) => Verdict::Passed,
            _ => Verdict::Failed,
        }
    }
}

impl Judging for StandIn {
    fn sandbox(&self) -> String {
        "Nothing was compiled.".to_owned()
    }

    fn canaries(&self) -> Result<(), String> {
        self.canaries.clone()
    }

    fn key(&self, submission: &Submission) -> Result<String, String> {
        let slugs: Vec<&str> = self.exercises.iter().map(|exercise| exercise.slug).collect();
        Ok(format!("{}/{}/{}", Self::answer(submission)?, self.seed.text(), slugs.join(",")))
    }

    fn collected(&self, submission: &Submission) -> Result<Collected, String> {
        assert_ne!(Self::answer(submission)?, "later", "a judge that panics");
        collect(submission)
    }

    fn grade(&self, submission: &Submission, student: Option<String>) -> Grade {
        if self.graded.fetch_add(1, Ordering::SeqCst) >= self.last {
            std::process::abort();
        }
        if let Some(log) = &self.log {
            use std::io::Write;
            let mut log = fs::File::options().create(true).append(true).open(log).expect("a log");
            writeln!(log, "{}", submission.name).expect("a line");
        }
        let answer = Self::answer(submission).unwrap_or_else(|_| "cannot".to_owned());
        assert_ne!(answer, "panic", "a judge that panics");
        if answer == "abort" {
            std::process::abort();
        }
        let exercises = self.exercises.iter().map(|exercise| {
            let check =
                |name: &str, hidden| check(name, hidden, self.dice(&answer, exercise.slug, name));
            let names = ["one", "two", "three"];
            let public = names.iter().map(|name| check(name, false));
            ExerciseGrade {
                exercise: exercise.slug.to_owned(),
                title: exercise.title.to_owned(),
                outcome: Outcome::Ran,
                points: self.points.of(exercise.slug),
                checks: public.chain(names.iter().map(|name| check(name, true))).collect(),
                marked: None,
                words: None,
                comments: Vec::new(),
            }
        });
        Grade {
            submission: submission.name.clone(),
            student,
            key: self.key(submission).unwrap_or_default(),
            notices: Vec::new(),
            late: None,
            exercises: exercises.collect(),
        }
    }
}
