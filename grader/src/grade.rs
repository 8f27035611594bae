//! What a grade is: the contents of `grade.json`, from which every other report is made.

use exercise_spec::Question;
use serde::{Deserialize, Serialize};

/// The version of the form of `grade.json`. It grows when a field changes its meaning.
pub const VERSION: u32 = 2;

/// A batch of graded submissions: `grade.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// [`VERSION`].
    pub version: u32,
    /// The mark of the seed that hidden instances were drawn from. The same one gives the same grades.
    pub instances: String,
    /// What stood around the compiler, in a sentence for the instructor.
    pub sandbox: String,
    /// One grade for each submission, in the order of their names.
    pub grades: Vec<Grade>,
}

/// The grade of one submission.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grade {
    /// Name of the submission's folder, made harmless: no control characters, no separators.
    pub submission: String,
    /// Who handed it in, from the roster.
    pub student: Option<String>,
    /// Digest of the answers, the seed, the points and the checks: the same key, the same grade.
    pub key: String,
    /// What the instructor and the student should know and costs nothing: files that were left out.
    pub notices: Vec<String>,
    /// Set where the roster says how late it came.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub late: Option<Late>,
    /// In the order of the book.
    pub exercises: Vec<ExerciseGrade>,
}

/// The grade of one exercise, or of the question of a chapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExerciseGrade {
    /// Slug of the exercise or of the chapter.
    pub exercise: String,
    /// What its page is called.
    pub title: String,
    /// What became of it.
    pub outcome: Outcome,
    /// What its program can earn.
    pub points: f64,
    /// One for each check, public ones first. Empty when the answer never ran.
    pub checks: Vec<CheckGrade>,
    /// Points that a person gave in place of those that the checks give.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub marked: Option<f64>,
    /// The answer in words, where it has points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub words: Option<WordsGrade>,
    /// What a person says of it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub comments: Vec<String>,
}

/// Points of a person for an answer in words.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WordsGrade {
    /// What can be earned.
    pub of: f64,
    /// What is earned.
    pub earned: f64,
}

/// What is taken off because a submission came too late.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Late {
    /// How late it came.
    pub days: f64,
    /// What is taken off, in percent.
    pub percent: f64,
}

/// What became of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "is", content = "why")]
pub enum Outcome {
    /// It ran, and its checks say the rest.
    Ran,
    /// There is no such file; it earns nothing.
    Missing,
    /// It is the skeleton as it was handed out; it earns nothing.
    NotBegun,
    /// The source screen or what the compiler read says no; it earns nothing.
    Refused(String),
    /// It does not compile, or not within the limits; it earns nothing.
    DoesNotCompile(String),
    /// The grader failed and not the student. This is never a zero: a person must look.
    CouldNotGrade(String),
    /// A chapter asks it in words. There is no program, and a person gives its points.
    InWords,
}

/// The outcome of one check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckGrade {
    /// What it states.
    pub name: String,
    /// Whether students do not have its instances.
    pub hidden: bool,
    /// Its share of the points, beside the weights of the others.
    pub weight: f64,
    /// Passed, failed, or could not be graded.
    pub verdict: Verdict,
    /// What is wrong, in words of the subject; empty when it passed.
    pub sentence: String,
    /// The same without the words of the answer, if it has said any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quiet: Option<String>,
    /// Numbers expected and obtained; may be empty.
    pub numbers: String,
    /// Name of the misconception that was recognized.
    pub misconception: Option<String>,
    /// Expected and obtained as SVG, where that can be drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
}

/// Three outcomes, never two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The answer does what the check states.
    Passed,
    /// It does not.
    Failed,
    /// Nobody knows, because the grader failed.
    CouldNotGrade,
}

impl ExerciseGrade {
    /// The grade of a chapter's question, before a person has marked the answer.
    pub fn in_words(question: &Question) -> Self {
        Self {
            exercise: question.slug.to_owned(),
            title: question.title.to_owned(),
            outcome: Outcome::InWords,
            points: 0.0,
            checks: Vec::new(),
            marked: None,
            words: None,
            comments: Vec::new(),
        }
    }

    /// Whether a person has said anything of it.
    pub fn is_marked(&self) -> bool {
        self.marked.is_some() || self.words.is_some() || !self.comments.is_empty()
    }

    /// What it earns: what its program earns, and its words where they have points. Nothing at all,
    /// and not zero, when it could not be graded.
    pub fn earned(&self) -> Option<f64> {
        Some(self.program()? + self.words.map_or(0.0, |words| words.earned))
    }

    /// What its program earns, by its checks or by a person.
    pub fn program(&self) -> Option<f64> {
        self.marked.or_else(|| self.of_checks())
    }

    /// What can be earned.
    pub fn of(&self) -> f64 {
        self.points + self.words.map_or(0.0, |words| words.of)
    }

    /// The points of its program by the weights of the checks that passed.
    fn of_checks(&self) -> Option<f64> {
        match self.outcome {
            Outcome::CouldNotGrade(_) => return None,
            Outcome::Missing
            | Outcome::NotBegun
            | Outcome::Refused(_)
            | Outcome::DoesNotCompile(_)
            | Outcome::InWords => return Some(0.0),
            Outcome::Ran => {}
        }
        if self.checks.iter().any(|check| check.verdict == Verdict::CouldNotGrade) {
            return None;
        }
        let weight = |passed: bool| {
            let counted = self.checks.iter().filter(|c| !passed || c.verdict == Verdict::Passed);
            counted.fold(0.0, |sum, check| sum + check.weight)
        };
        let all = weight(false);
        Some(if all > 0.0 { self.points * weight(true) / all } else { 0.0 })
    }

    /// Names of the misconceptions that its checks recognized, each once.
    pub fn misconceptions(&self) -> Vec<&str> {
        let mut names: Vec<&str> =
            self.checks.iter().filter_map(|check| check.misconception.as_deref()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}

impl Grade {
    /// What it earns in all, or nothing when one of its exercises could not be graded.
    pub fn earned(&self) -> Option<f64> {
        self.exercises.iter().try_fold(0.0, |sum, exercise| Some(sum + exercise.earned()?))
    }

    /// What is left of it when what is taken off for lateness is gone.
    pub fn after_lateness(&self) -> Option<f64> {
        let percent = self.late.map_or(0.0, |late| late.percent);
        Some(self.earned()? * (1.0 - percent / 100.0))
    }

    /// What can be earned in all.
    pub fn points(&self) -> f64 {
        self.exercises.iter().fold(0.0, |sum, exercise| sum + exercise.of())
    }

    /// The exercises that ask for a program.
    pub fn programs(&self) -> impl Iterator<Item = &ExerciseGrade> {
        self.exercises.iter().filter(|exercise| exercise.outcome != Outcome::InWords)
    }

    /// Whether no program was found at all.
    pub fn is_empty(&self) -> bool {
        self.programs().all(|exercise| exercise.outcome == Outcome::Missing)
    }

    /// What could not be graded: exercises and why.
    pub fn ungraded(&self) -> impl Iterator<Item = &ExerciseGrade> {
        self.exercises.iter().filter(|exercise| exercise.earned().is_none())
    }
}
