//! Asks an answer the questions of the checks, and keeps the expected values to itself.

use std::collections::BTreeMap;
use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use book_tests::hidden_checks;
use exercise_runner::picture;
use exercise_spec::Exercise;
use exercise_spec::check::{Check, Failure};
use sha2::{Digest, Sha256};

use crate::budget::{Compiling, Purse, Running};
use crate::compile::{Answers, Compiled, Compiler, edition, number_of};
use crate::export::{every_skeleton, newest_skeleton};
use crate::grade::{CheckGrade, ExerciseGrade, Grade, Outcome, Verdict};
use crate::machine::{Answer, FEWER_STEPS, INSTANCE, LOADING, Machine, Program, STEPS, no_time};
use crate::memory::Memory;
use crate::points::Points;
use crate::repository;
use crate::screen::screen;
use crate::seed::Seed;
use crate::submission::{self, Collected, Submission};
use crate::text::{harmless, harmless_line};

/// Longest sentence and longest table that a check may put into a report.
const LONGEST: [usize; 2] = [1_000, 4_000];

/// Grades submissions, any number of them and several at a time.
pub struct Judge {
    compiler: Compiler,
    machine: Machine,
    memory: Memory,
    points: Points,
    seed: Seed,
    exercises: Vec<Asked>,
}

/// An exercise with its checks on instances that are drawn.
struct Asked {
    exercise: &'static Exercise,
    number: usize,
    checks: Vec<(bool, Check)>,
    /// The skeletons of all editions, without white space at the ends of lines.
    skeletons: Vec<String>,
}

/// The text of an answer, or what became of it without being compiled.
type Screened = Result<(&'static str, String), (&'static str, Outcome)>;

/// What can be asked, or the outcome without asking, by the slug of the exercise.
type Ready = BTreeMap<&'static str, Result<Arc<Program>, Outcome>>;

impl Judge {
    /// A judge with compiler, machine and hidden instances of a seed.
    ///
    /// # Errors
    ///
    /// When there is no compiler or no machine.
    pub fn prepare(
        points: Points,
        seed: Seed,
        exercises: &[&'static Exercise],
        memory: Memory,
    ) -> Result<Self, String> {
        let asked = |exercise: &&'static Exercise| {
            let hidden = hidden_checks(exercise.slug, seed.number())
                .ok_or_else(|| format!("{} has no hidden checks", exercise.slug))?;
            let public = (exercise.checks)().into_iter().map(|check| (false, check));
            let number = number_of(exercise.slug)
                .ok_or_else(|| format!("{} is not in the list", exercise.slug))?;
            let checks = public.chain(hidden.into_iter().map(|check| (true, check))).collect();
            let skeletons = every_skeleton(&repository(), exercise.slug)?;
            let skeletons = skeletons.iter().map(|text| trimmed(text)).collect();
            Ok::<Asked, String>(Asked { exercise, number, checks, skeletons })
        };
        Ok(Self {
            exercises: exercises.iter().map(asked).collect::<Result<_, _>>()?,
            compiler: Compiler::prepare()?,
            machine: Machine::new()?,
            memory,
            points,
            seed,
        })
    }

    /// What stands around the compiler, in a sentence for the instructor.
    pub fn sandbox(&self) -> String {
        self.compiler.sandbox()
    }

    /// The digest of everything that decides a grade.
    pub fn key(&self, collected: &Collected) -> String {
        let points = serde_json::to_string(&self.points).unwrap_or_default();
        let slugs: Vec<&str> = self.exercises.iter().map(|asked| asked.exercise.slug).collect();
        let skeletons: Vec<&Vec<String>> =
            self.exercises.iter().map(|asked| &asked.skeletons).collect();
        let parts = format!(
            "{:?} {points} {} {slugs:?} {skeletons:?}",
            (&collected.answers, &collected.refused, &collected.notices),
            self.seed.text()
        );
        let digest = Sha256::new().chain_update(edition()).chain_update(parts).finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Grades a submission. Whatever it is, there is a grade; what could not be graded says so.
    pub fn grade(&self, submission: &Submission, student: Option<String>) -> Grade {
        let collected = submission::collect(submission);
        let (key, notices) = match &collected {
            Ok(collected) => (self.key(collected), collected.notices.clone()),
            Err(_) => Default::default(),
        };
        let exercises = match collected {
            Ok(collected) => self.graded_all(self.screened(&collected)),
            Err(why) => {
                let not =
                    |asked: &Asked| Err((asked.exercise.slug, Outcome::CouldNotGrade(why.clone())));
                self.graded_all(self.exercises.iter().map(not).collect())
            }
        };
        Grade { submission: submission.name.clone(), student, key, notices, late: None, exercises }
    }

    /// Grades texts that need no screen, because they are known.
    pub fn grade_texts(&self, texts: &Answers) -> Vec<ExerciseGrade> {
        self.graded_all(texts.iter().map(|(slug, text)| Ok((*slug, text.clone()))).collect())
    }

    /// The texts that may be compiled, and what became of the others.
    fn screened(&self, collected: &Collected) -> Vec<Screened> {
        let screened = |asked: &Asked| {
            let slug = asked.exercise.slug;
            match (collected.answers.get(slug), collected.refused.get(slug)) {
                (_, Some(why)) => Err((slug, Outcome::Refused(why.clone()))),
                (None, None) => Err((slug, Outcome::Missing)),
                (Some(text), None) if asked.skeletons.contains(&trimmed(text)) => {
                    Err((slug, Outcome::NotBegun))
                }
                (Some(text), None) => match screen(slug, text) {
                    Ok(()) => Ok((slug, text.clone())),
                    Err(why) => Err((slug, Outcome::Refused(why))),
                },
            }
        };
        self.exercises.iter().map(screened).collect()
    }

    /// Compiles and asks: all at once, and one by one where the answers do not compile together,
    /// so that an error in one of them costs that one alone.
    fn graded_all(&self, screened: Vec<Screened>) -> Vec<ExerciseGrade> {
        let mut answers = BTreeMap::new();
        let mut ready = BTreeMap::new();
        for one in screened {
            match one {
                Ok((slug, text)) => drop(answers.insert(slug, text)),
                Err((slug, outcome)) => drop(ready.insert(slug, Err(outcome))),
            }
        }
        let program = |answers: &Answers, time| {
            self.program(self.compiler.compile(answers, time, &self.memory))
        };
        let mut time = Compiling::new();
        let together =
            if answers.len() > 1 { program(&answers, time.together()).ok() } else { None };
        let mut to_come = answers.len();
        for (slug, text) in answers {
            let alone = || {
                let (begun, most) = (Instant::now(), time.alone(to_come));
                let program = program(&BTreeMap::from([(slug, text)]), most);
                // On a machine that is busy the clock says more than the processor.
                time.took(begun.elapsed().min(most));
                program
            };
            ready.insert(slug, together.clone().map_or_else(alone, Ok));
            to_come -= 1;
        }
        self.asked(&ready)
    }

    /// Asks every exercise, all of them at a time.
    fn asked(&self, ready: &Ready) -> Vec<ExerciseGrade> {
        let time = Running::new();
        let graded = |asked: &Asked| {
            let missing = Err(Outcome::Missing);
            let ready = ready.get(asked.exercise.slug).unwrap_or(&missing);
            self.graded(asked, ready, &time.of_answer())
        };
        thread::scope(|scope| {
            let asked = self.exercises.iter().map(|asked| scope.spawn(|| graded(asked)));
            let asked: Vec<_> = asked.collect();
            asked
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(|p| panic::resume_unwind(p)))
                .collect()
        })
    }

    fn program(&self, compiled: Compiled) -> Result<Arc<Program>, Outcome> {
        match compiled {
            Compiled::Module(module) => {
                let _part = self.memory.take(LOADING);
                self.machine.load(&module).map(Arc::new).map_err(Outcome::Refused)
            }
            Compiled::Refused(why) => Err(Outcome::Refused(why)),
            Compiled::DoesNotCompile(why) => Err(Outcome::DoesNotCompile(why)),
            Compiled::CouldNotCompile(why) => Err(Outcome::CouldNotGrade(why)),
        }
    }

    fn graded(
        &self,
        asked: &Asked,
        ready: &Result<Arc<Program>, Outcome>,
        purse: &Purse,
    ) -> ExerciseGrade {
        let (outcome, checks) = match ready {
            Err(outcome) => (outcome.clone(), Vec::new()),
            Ok(program) => {
                let mut steps = STEPS;
                let ask = |(hidden, check): &(bool, Check)| {
                    if purse.is_empty() {
                        let failure = Failure::from(no_time());
                        return self.told(asked, *hidden, check, Verdict::Failed, Some(failure));
                    }
                    let _part = self.memory.take(INSTANCE);
                    let answer = program.answer(asked.number, steps, purse);
                    let grade = self.ask(asked, &answer, *hidden, check);
                    steps = if answer.took_too_long() { FEWER_STEPS } else { steps };
                    grade
                };
                (Outcome::Ran, asked.checks.iter().map(ask).collect())
            }
        };
        let exercise = asked.exercise;
        ExerciseGrade {
            exercise: exercise.slug.to_owned(),
            title: exercise.title.to_owned(),
            outcome,
            points: self.points.of(exercise.slug),
            checks,
            marked: None,
            words: None,
            comments: Vec::new(),
        }
    }

    /// Runs one check on an instance that nobody else has asked.
    fn ask(&self, asked: &Asked, answer: &Answer, hidden: bool, check: &Check) -> CheckGrade {
        let outcome = panic::catch_unwind(AssertUnwindSafe(|| check.run(answer)));
        let (verdict, failure) = match (answer.unjust(), outcome) {
            (Some(why), _) => (Verdict::CouldNotGrade, Some(Failure::new(why))),
            (None, Err(_)) => {
                let sentence = "the check itself failed on this output; a person must look at it";
                (Verdict::CouldNotGrade, Some(Failure::new(sentence)))
            }
            (None, Ok(Ok(()))) => (Verdict::Passed, None),
            (None, Ok(Err(failure))) => (Verdict::Failed, Some(failure)),
        };
        self.told(asked, hidden, check, verdict, failure)
    }

    /// The grade of a check from what came out.
    fn told(
        &self,
        asked: &Asked,
        hidden: bool,
        check: &Check,
        verdict: Verdict,
        failure: Option<Failure>,
    ) -> CheckGrade {
        let told = |of: fn(&Failure) -> &str, most| {
            failure.as_ref().map_or(String::new(), |f| harmless(of(f), most))
        };
        CheckGrade {
            name: check.name.to_owned(),
            hidden,
            weight: self.points.weight(asked.exercise.slug, check.name, hidden),
            verdict,
            sentence: harmless_line(&told(|failure| &failure.sentence, LONGEST[0]), LONGEST[0]),
            quiet: failure.as_ref().and_then(|failure| failure.quiet.clone()),
            numbers: told(|failure| &failure.numbers, LONGEST[1]),
            misconception: failure
                .as_ref()
                .and_then(|f| f.misconception)
                .map(|known| known.name.to_owned()),
            picture: failure.as_ref().and_then(|f| picture::svg(f.picture.as_deref()?).ok()),
        }
    }

    /// Grades answers that are known: the reference earns everything, and the skeletons nothing.
    /// Skeletons are compiled every time, which shows that the compiler can; the reference only
    /// when something has changed.
    ///
    /// # Errors
    ///
    /// When one of them comes out otherwise. Then no grade can be trusted.
    pub fn canaries(&self) -> Result<(), String> {
        let root = repository();
        let reference = self.known(|slug| Ok(format!("solutions/src/{slug}.rs")))?;
        let program = self.program(self.compiler.compile_once(&reference, &self.memory));
        let ready = reference.into_keys().map(|slug| (slug, program.clone())).collect();
        for exercise in self.asked(&ready) {
            if exercise.earned() != Some(exercise.points) {
                return Err(unexpected("reference answer", &exercise));
            }
        }
        let skeletons = self.known(|slug| newest_skeleton(&root, slug).map(|(_, path)| path))?;
        for exercise in self.grade_texts(&skeletons) {
            if exercise.earned() != Some(0.0) || exercise.outcome != Outcome::Ran {
                return Err(unexpected("skeleton", &exercise));
            }
        }
        Ok(())
    }

    /// Texts of the repository, one for each exercise. The screen must let them through.
    fn known(&self, path: impl Fn(&str) -> Result<String, String>) -> Result<Answers, String> {
        let text = |asked: &Asked| {
            let slug = asked.exercise.slug;
            let path = path(slug)?;
            let text = fs::read_to_string(repository().join(&path))
                .map_err(|error| format!("cannot read {path}: {error}"))?;
            screen(slug, &text).map_err(|why| format!("{path} is refused: {why}"))?;
            Ok((slug, text))
        };
        self.exercises.iter().map(text).collect()
    }
}

/// A text without what editors and systems change in it unasked: the ends of its lines and white
/// space before them, and the mark of its encoding.
fn trimmed(text: &str) -> String {
    let text = text.trim_start_matches('\u{feff}').trim_end();
    text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

/// What a known answer should not have got, with the first thing that its grade says.
fn unexpected(what: &str, exercise: &ExerciseGrade) -> String {
    let check = exercise.checks.iter().find(|check| check.verdict != Verdict::Passed);
    format!(
        "the {what} of {} earns {:?}: {:?} {}",
        exercise.exercise,
        exercise.earned(),
        exercise.outcome,
        check.map_or("", |check| &check.sentence)
    )
}
