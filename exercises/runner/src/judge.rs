//! The tests of one answer.

use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use exercise_spec::Exercise;
use exercise_spec::answer::Native;
use exercise_spec::check::Failure;
use exercise_spec::declaration::Dispatch;
use libtest_mimic::{Arguments, Failed, Trial};

use crate::folder::{self, Folder};
use crate::progress::Verdicts;
use crate::{names, picture, selection};

/// Runs the checks of an exercise on an answer, prints what is wrong, and keeps the outcome for
/// the list of progress. `source` is the answer's text. One that the grader refuses for its names is
/// not asked.
pub fn judge(
    exercise: &'static Exercise,
    source: &str,
    functions: impl Dispatch + 'static,
) -> ExitCode {
    let mut arguments = Arguments::from_args();
    let taken = names::taken(exercise, source);
    if let (Some(first), false) = (taken.first(), arguments.list) {
        for name in &taken {
            println!("{}", selection::wrapped(&names::refusal(name), 96));
        }
        keep(&Verdicts::new(exercise.slug, source).refused(first));
        return ExitCode::FAILURE;
    }
    // The name of the exercise selects all its checks; they do not repeat it.
    arguments.filter = arguments.filter.filter(|filter| !exercise.slug.contains(filter.as_str()));
    // One after the other, so that what is wrong first is told first.
    arguments.test_threads = Some(1);
    let partial = arguments.filter.is_some() || !arguments.skip.is_empty() || arguments.list;
    let answer = Arc::new(Native(functions));
    let verdicts = Arc::new(Mutex::new(Verdicts::new(exercise.slug, source)));
    let trials = (exercise.checks)().into_iter().map(|check| {
        let (answer, verdicts) = (Arc::clone(&answer), Arc::clone(&verdicts));
        Trial::test(format!("{}::{}", exercise.slug, check.name), move || {
            let outcome = check.run(&*answer);
            if let Ok(mut verdicts) = verdicts.lock() {
                verdicts.add(check.name, &outcome);
            }
            let path = Folder::here().picture(exercise.slug, check.name);
            // Of an earlier answer there may be a picture.
            let _ = std::fs::remove_file(&path);
            outcome.map_err(|failure| Failed::from(told(&path, &failure)))
        })
    });
    let conclusion = libtest_mimic::run(&arguments, trials.collect());
    let kept = verdicts.lock().map(|verdicts| verdicts.clone());
    if let (false, Ok(verdicts)) = (partial, kept) {
        keep(&verdicts);
    }
    if conclusion.has_failed() {
        println!("A hint: cargo run -p exercises -- hint {}", exercise.slug);
    }
    conclusion.exit_code()
}

/// Keeps an outcome, unless there is no room for it.
fn keep(verdicts: &Verdicts) {
    if let Err(error) = verdicts.keep(&Folder::here()) {
        eprintln!("the outcome could not be kept for the list of progress: {error}");
    }
}

/// A failure as the terminal shows it, with the path of its picture.
fn told(path: &Path, failure: &Failure) -> String {
    let mut text = selection::wrapped(&failure.sentence, 96);
    if !failure.numbers.is_empty() {
        let _ = write!(text, "\n\n{}", failure.numbers.trim_end());
    }
    if let Some(drawn) = &failure.picture {
        let kept = picture::svg(drawn).and_then(|svg| folder::write(path, &svg));
        let _ = match kept {
            Ok(()) => write!(text, "\n\nexpected and obtained, drawn: {}", path.display()),
            Err(error) => write!(text, "\n\nno picture could be drawn: {error}"),
        };
    }
    text
}
