//! A corpus of hostile submissions. None earns what it has not earned, none stops the others, none
//! leaves anything behind, and each is told something it can act on.
//!
//! Every third of them is graded at every change, and all before a chapter is called done:
//! `cargo test -p grader --test hostile -- --ignored`. `HOSTILE=words` before that command grades
//! those alone whose names have these words.

mod cheating;
mod corpus;
mod exhausting;
mod handing_in;
mod leaving;
mod past;
mod reaching;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use corpus::{Hostile, Made, Want, put, right};
use exercise_spec::EXERCISES;
use exercise_spec::answer::{Fault, Transport};
use grader::batch::{self, Order};
use grader::budget::Running;
use grader::grade::{Batch, ExerciseGrade, Grade, Outcome, Verdict};
use grader::machine::{Machine, STEPS};
use grader::report::Detail;
use grader::seed::Seed;
use grader::submission::{find, has_answers};
use grader::text::harmless;

/// Held by those who compile, so that each can say what it leaves behind.
static COMPILING: Mutex<()> = Mutex::new(());

fn corpus() -> Vec<Hostile> {
    let mut all = handing_in::all();
    all.extend(leaving::all());
    all.extend(reaching::all());
    all.extend(cheating::all());
    all.extend(exhausting::all());
    if let Ok(wanted) = std::env::var("HOSTILE") {
        all.retain(|hostile| hostile.name.contains(&wanted));
    }
    all
}

#[test]
fn there_are_many_and_each_is_another() {
    let all = corpus();
    let names: BTreeSet<&str> = all.iter().map(|hostile| hostile.name).collect();
    assert_eq!(names.len(), all.len());
    assert!(names.len() >= 150 || std::env::var_os("HOSTILE").is_some(), "{}", names.len());
    for Hostile { made, exercise, name, .. } in &all {
        if let Made::Answer(text) = made {
            assert_ne!(*text, right(exercise), "{name} is the right answer");
        }
    }
}

#[test]
fn none_of_a_third_earns_what_it_has_not_earned_and_each_is_told_what_to_do() {
    none_earns_what_it_has_not_earned(corpus().into_iter().step_by(3).collect());
}

#[test]
#[ignore = "three minutes: every one of them"]
fn none_earns_what_it_has_not_earned_and_each_is_told_what_to_do() {
    none_earns_what_it_has_not_earned(corpus());
}

fn none_earns_what_it_has_not_earned(all: Vec<Hostile>) {
    let _alone = COMPILING.lock().unwrap_or_else(|held| held.into_inner());
    let folder = tempfile::tempdir().expect("a folder");
    let (root, out) = (folder.path().join("batch"), folder.path().join("out"));
    let folders: Vec<PathBuf> =
        all.iter().enumerate().map(|(at, it)| hand_in(&root, at, it)).collect();
    honest(&root);
    let before = tree(&root);
    batch::carry_out(&order(&root, &out)).expect("a batch that nobody has stopped");
    let batch = fs::read_to_string(out.join("grade.json")).expect("the grades");
    let batch: Batch = serde_json::from_str(&batch).expect("a batch");

    let wrong: Vec<String> = all
        .iter()
        .zip(&folders)
        .filter_map(|(hostile, folder)| {
            let why = became(hostile, grade_of(&batch, &root, folder)).err()?;
            Some(format!("{}: {why}", hostile.name))
        })
        .collect();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), all.len(), wrong.join("\n"));
    honest_were_graded(&batch, &root);
    assert_eq!(batch.grades.len(), all.len() + 2);
    assert_eq!(tree(&root), before, "a submission was changed");
    assert_eq!(left_behind(), Vec::<String>::new());
    reports_are_harmless(&out, all.len());
}

fn order(root: &Path, out: &Path) -> Order {
    Order {
        submissions: vec![root.to_owned()],
        single: false,
        exercises: Vec::new(),
        seed: Some(Seed::new(20_261_121)),
        detail: Detail::Full,
        out: out.to_owned(),
        roster: None,
        marks: None,
        points: None,
        jobs: None,
        memory: None,
    }
}

/// Lays a submission into the batch.
fn hand_in(root: &Path, number: usize, hostile: &Hostile) -> PathBuf {
    let folder = root.join(hostile.folder.map_or(format!("{number:03}"), str::to_owned));
    fs::create_dir_all(&folder).expect("a folder");
    match &hostile.made {
        Made::Answer(text) => put(&folder, &format!("{}.rs", hostile.exercise), text),
        Made::Folder(made) => made(&folder),
    }
    folder
}

/// One who has everything right, and one who has made one mistake.
fn honest(root: &Path) {
    for exercise in EXERCISES {
        let file = format!("exercises/src/{}.rs", exercise.slug);
        put(root, &format!("honest/{file}"), right(exercise.slug));
        put(root, &format!("unlucky/{file}"), right(exercise.slug));
    }
    put(root, "unlucky/exercises/src/fill_in.rs", "pub fn new_couplings() { oh no }");
}

fn honest_were_graded(batch: &Batch, root: &Path) {
    let all = 10.0 * EXERCISES.len() as f64;
    assert_eq!(grade_of(batch, root, &root.join("honest")).earned(), Some(all));
    let unlucky = grade_of(batch, root, &root.join("unlucky"));
    assert_eq!(unlucky.earned(), Some(all - 10.0), "an error in one answer costs that one alone");
}

fn grade_of<'a>(batch: &'a Batch, root: &Path, folder: &Path) -> &'a Grade {
    let root = root.canonicalize().expect("a path");
    let path = root.join(folder.file_name().expect("a name"));
    let found = find(&[root], has_answers).expect("found");
    let name = &found.iter().find(|it| it.path == path).expect("found").name;
    batch.grades.iter().find(|grade| grade.submission == *name).expect("a grade")
}

/// Whether a submission became what it must.
fn became(hostile: &Hostile, grade: &Grade) -> Result<(), String> {
    let name = &grade.submission;
    if name.is_empty() || name.chars().any(|c| c.is_control() || "/\\:<>|\"*?".contains(c)) {
        return Err(format!("its name is {name:?}"));
    }
    let others = grade.exercises.iter().filter(|other| other.exercise != hostile.exercise);
    for other in others.filter(|_| hostile.want != Want::NotGraded) {
        if other.outcome != Outcome::Missing || other.earned() != Some(0.0) {
            return Err(format!("{} is {:?}", other.exercise, other.outcome));
        }
    }
    let exercise = grade.exercises.iter().find(|it| it.exercise == hostile.exercise);
    let exercise = exercise.ok_or("it has no grade")?;
    let told = told(grade, exercise);
    let (outcome, earned) = (&exercise.outcome, exercise.earned());
    if !as_wanted(exercise, hostile.want) {
        return Err(format!(
            "it earns {earned:?}, wanted was {:?}; {outcome:?}: {told}",
            hostile.want
        ));
    }
    if !told.contains(hostile.says) {
        return Err(format!("it is not told {:?}; {outcome:?}: {told}", hostile.says));
    }
    if told.is_empty() && hostile.want != Want::NotBegun && earned != Some(exercise.points) {
        return Err("it is told nothing".to_owned());
    }
    if told.len() > 200_000 {
        return Err(format!("{} bytes are told", told.len()));
    }
    match told.lines().find(|line| harmless(line, usize::MAX) != *line) {
        Some(line) => Err(format!("this gets through: {line:?}")),
        None => Ok(()),
    }
}

fn as_wanted(exercise: &ExerciseGrade, want: Want) -> bool {
    match (&exercise.outcome, want) {
        (Outcome::CouldNotGrade(_), Want::NotGraded) => exercise.earned().is_none(),
        (Outcome::Missing, Want::Missing)
        | (Outcome::NotBegun, Want::NotBegun)
        | (Outcome::Refused(_), Want::Refused)
        | (Outcome::DoesNotCompile(_), Want::DoesNotCompile) => exercise.earned() == Some(0.0),
        (Outcome::Ran, Want::Runs(most)) => {
            exercise.earned().is_some_and(|earned| earned <= most * exercise.points + 1e-9)
        }
        _ => false,
    }
}

/// Everything that somebody reads of it.
fn told(grade: &Grade, exercise: &ExerciseGrade) -> String {
    let mut told = grade.notices.clone();
    match &exercise.outcome {
        Outcome::Refused(why) | Outcome::DoesNotCompile(why) | Outcome::CouldNotGrade(why) => {
            told.push(why.clone());
        }
        Outcome::Ran | Outcome::Missing | Outcome::NotBegun | Outcome::InWords => {}
    }
    for check in exercise.checks.iter().filter(|check| check.verdict != Verdict::Passed) {
        told.push(format!("{}: {}\n{}", check.name, check.sentence, check.numbers));
    }
    told.join("\n")
}

/// Every path below a folder with what can be told of it without opening pipes.
fn tree(root: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder").flatten() {
            let metadata = fs::symlink_metadata(entry.path()).expect("metadata");
            let (kind, size) = (metadata.file_type(), metadata.len());
            let changed = metadata.modified().expect("a time");
            found.insert(format!("{:?} {kind:?} {size} {changed:?}", entry.path()));
            if metadata.is_dir() {
                folders.push(entry.path());
            }
        }
    }
    found
}

/// Files and processes of compilations that are over.
fn left_behind() -> Vec<String> {
    let runs = grader::repository().join("target/grader/runs");
    let mut left = Vec::new();
    for run in fs::read_dir(&runs).into_iter().flatten().flatten() {
        let answers = fs::read_dir(run.path().join("answers")).into_iter().flatten().flatten();
        left.extend(answers.map(|entry| entry.path().display().to_string()));
    }
    for process in fs::read_dir("/proc").into_iter().flatten().flatten() {
        let words = fs::read(process.path().join("cmdline")).unwrap_or_default();
        let words = String::from_utf8_lossy(&words).replace('\0', " ");
        if words.contains(&*runs.to_string_lossy()) {
            left.push(words);
        }
    }
    let marks = ["hostile-toolchain-ran"].map(|mark| std::env::temp_dir().join(mark));
    left.extend(marks.iter().filter(|mark| mark.exists()).map(|mark| mark.display().to_string()));
    left
}

/// No report holds what does something to a terminal, and each is what it says it is.
fn reports_are_harmless(out: &Path, submissions: usize) {
    let mut count = 0;
    let mut folders = vec![out.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            count += 1;
            let text = fs::read_to_string(&path).expect("a text");
            let trap =
                text.lines().find(|line| harmless(line, usize::MAX) != line.replace('\t', " "));
            assert_eq!(trap, None, "{}", path.display());
            if path.extension().is_some_and(|ending| ending == "json") {
                let read = serde_json::from_str::<serde_json::Value>(&text);
                assert!(read.is_ok(), "{}", path.display());
            }
        }
    }
    assert!(count > 2 * submissions, "{count} reports");
}

/// Modules that no compiler has made, byte for byte.
#[test]
fn a_module_that_asks_for_too_much_does_not_begin() {
    let machine = Machine::new().expect("a machine");
    let module = |section: &[u8]| [b"\0asm\x01\0\0\0", section].concat();
    let refused = |bytes: &[u8]| machine.load(&module(bytes)).err().expect("refused");
    // One memory of 5000 pages, which are 312 MB.
    let program = machine.load(&module(&[5, 4, 1, 0, 0x88, 0x27])).expect("a module");
    let answer = program.answer(0, STEPS, &Running::new().of_answer());
    let too_much = "it needs more memory than the 256 MB it may have".to_owned();
    assert_eq!(answer.call(0, &[]), Err(Fault::Stopped(too_much)));
    assert_eq!(answer.unjust(), None);
    // A type of functions without arguments, and one of them: `exit` of `wasi`.
    let import = b"\x01\x04\x01\x60\0\0\x02\x0d\x01\x04wasi\x04exit\0\0";
    assert!(refused(import).starts_with("The compiled answer wants exit from outside."));
    assert!(refused(b"nothing").starts_with("The module cannot be loaded: "));
}
