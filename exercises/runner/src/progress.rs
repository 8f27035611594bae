//! How far the answers are.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use exercise_spec::check::Failure;
use exercise_spec::{EXERCISES, Exercise};

use crate::edition;
use crate::folder::{Folder, read};

/// Before the name in the line of an answer that is refused.
const REFUSED: &str = "refused";

/// What the checks said about an answer, or that none was asked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdicts {
    slug: String,
    source: String,
    checks: Vec<(String, bool)>,
    /// A name for which it is refused.
    refused: Option<String>,
}

impl Verdicts {
    /// None yet, about an answer with this text.
    pub fn new(slug: &str, source: &str) -> Self {
        let (slug, source) = (slug.to_owned(), source.to_owned());
        Self { slug, source, checks: Vec::new(), refused: None }
    }

    /// That it is refused for a name.
    pub fn refused(self, name: &str) -> Self {
        Self { refused: Some(name.to_owned()), ..self }
    }

    /// One more.
    pub fn add(&mut self, check: &str, outcome: &Result<(), Failure>) {
        self.checks.push((check.to_owned(), outcome.is_ok()));
    }

    /// How many checks passed.
    pub fn passed(&self) -> usize {
        self.checks.iter().filter(|(_, passed)| *passed).count()
    }

    /// Keeps them, with the text that they are about.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written to.
    pub fn keep(&self, folder: &Folder) -> std::io::Result<()> {
        let word = |passed| if passed { "passed" } else { "failed" };
        let checks = self.checks.iter().map(|(check, passed)| (word(*passed), check));
        let lines = checks.chain(self.refused.iter().map(|name| (REFUSED, name)));
        let lines: String = lines.map(|(word, name)| format!("{word} {name}\n")).collect();
        folder.keep(&format!("{}.verdicts", self.slug), &lines)?;
        folder.keep(&format!("{}.judged", self.slug), &self.source)?;
        Ok(())
    }

    /// Those that were kept, if the answer and the checks are still the same.
    fn kept(folder: &Folder, slug: &str) -> Option<Self> {
        let source = read(&folder.kept(&format!("{slug}.judged"))).ok()?;
        if read(&folder.answer(slug)).ok()? != source {
            return None;
        }
        let lines = read(&folder.kept(&format!("{slug}.verdicts"))).ok()?;
        let mut kept = Self::new(slug, &source);
        for (word, name) in lines.lines().filter_map(|line| line.split_once(' ')) {
            match word {
                REFUSED => kept.refused = Some(name.to_owned()),
                _ => kept.checks.push((name.to_owned(), word == "passed")),
            }
        }
        let asked = exercise_spec::exercise(slug).map(|exercise| (exercise.checks)());
        let asked = asked.iter().flatten().map(|check| check.name).collect::<BTreeSet<_>>();
        let answered = kept.checks.iter().map(|(name, _)| name.as_str()).collect();
        (kept.refused.is_some() || asked == answered).then_some(kept)
    }
}

/// How far one answer is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// The skeleton as it was handed out.
    Untouched,
    /// Changed since its tests ran, or they never did.
    Unknown,
    /// It has this name, for which it is refused.
    Refused(String),
    /// Tested as it is.
    Judged {
        /// Checks that it passes.
        passed: usize,
        /// All checks.
        of: usize,
    },
    /// The file cannot be read, and why.
    Missing(String),
}

/// How far an answer is.
pub fn state(folder: &Folder, exercise: &Exercise) -> State {
    let answer = match read(&folder.answer(exercise.slug)) {
        Ok(answer) => answer,
        Err(error) => return State::Missing(error),
    };
    if edition::skeleton_of(folder, exercise.slug, &answer).as_ref() == Some(&answer) {
        return State::Untouched;
    }
    match Verdicts::kept(folder, exercise.slug) {
        None => State::Unknown,
        Some(Verdicts { refused: Some(name), .. }) => State::Refused(name),
        Some(verdicts) => {
            State::Judged { passed: verdicts.passed(), of: (exercise.checks)().len() }
        }
    }
}

/// Whether an answer passes every check.
pub fn is_solved(folder: &Folder, exercise: &Exercise) -> bool {
    matches!(state(folder, exercise), State::Judged { passed, of } if passed == of)
}

/// The first exercise that is not solved, of those behind one of them and then from the beginning
/// of the book.
pub fn next(folder: &Folder, after: Option<&str>) -> Option<&'static Exercise> {
    let place = EXERCISES.iter().position(|exercise| Some(exercise.slug) == after);
    let (before, behind) = EXERCISES.split_at(place.map_or(0, |place| place + 1));
    behind.iter().chain(before).find(|exercise| !is_solved(folder, exercise)).copied()
}

/// Exercises whose tests must run before their state is known.
pub fn to_judge(folder: &Folder) -> Vec<&'static Exercise> {
    let unknown = |exercise: &&&Exercise| state(folder, exercise) == State::Unknown;
    EXERCISES.iter().filter(unknown).copied().collect()
}

/// The list of all exercises and how far they are.
pub fn list(folder: &Folder) -> String {
    let mut text = String::new();
    let mut solved = 0;
    let widest = EXERCISES.iter().map(|exercise| exercise.title.len()).max().unwrap_or(0);
    for exercise in EXERCISES {
        let (mark, words) = match state(folder, exercise) {
            State::Untouched => (' ', "not begun".to_owned()),
            State::Unknown => ('?', "does not compile".to_owned()),
            State::Refused(name) => ('-', format!("refused: `{name}` needs another name")),
            State::Judged { passed, of } if passed == of => {
                solved += 1;
                ('x', "solved".to_owned())
            }
            State::Judged { passed, of } => ('-', format!("{passed} of {of} checks pass")),
            State::Missing(error) => ('!', error),
        };
        let _ = writeln!(text, "[{mark}] {:20} {:widest$}  {words}", exercise.slug, exercise.title);
    }
    let _ = writeln!(text, "\n{solved} of {} solved", EXERCISES.len());
    if let Some(Exercise { slug, .. }) = next(folder, None) {
        let _ =
            writeln!(text, "Next: exercises/src/{slug}.rs, then cargo test -p exercises {slug}");
    }
    text
}
