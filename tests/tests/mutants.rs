//! Whether the checks notice a reference answer that is slightly wrong.
//!
//! cargo-mutants lists the mutants. All of an exercise are modules of one program, which is called
//! once for each, so that they are compiled once and not nine hundred times. Those that survive
//! must be explained in `tests/mutants/survivors.toml`, and no other may be.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use exercise_spec::{EXERCISES, Exercise};
use serde::Deserialize;

/// How long a mutant may take: those that loop for ever are noticed by that.
const PATIENCE: Duration = Duration::from_secs(60);
/// How much memory, in kilobytes.
const MEMORY: &str = "4000000";

#[derive(Deserialize)]
struct Mutant {
    name: String,
    file: PathBuf,
    replacement: String,
    span: Span,
}

#[derive(Deserialize)]
struct Span {
    start: Place,
    end: Place,
}

/// Line and column in characters, both from one.
#[derive(Deserialize)]
struct Place {
    line: usize,
    column: usize,
}

/// A mutant that survives, known by what it changes and the line where it does.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
struct Survivor {
    exercise: String,
    change: String,
    line: String,
    #[serde(default)]
    why: String,
}

#[derive(Deserialize)]
struct Explained {
    survivor: Vec<Survivor>,
}

fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().expect("the repository")
}

/// `cargo mutants` must be installed: `cargo install --locked cargo-mutants`.
#[test]
#[ignore = "compiles every mutant of every reference answer"]
fn every_surviving_mutant_of_a_reference_answer_is_explained() {
    let known = fs::read_to_string(root().join("tests/mutants/survivors.toml")).expect("survivors");
    let known: Explained = toml::from_str(&known).expect("a list of survivors");
    assert!(known.survivor.iter().all(|survivor| !survivor.why.trim().is_empty()), "a reason each");
    let only = std::env::var("EXERCISE").ok();
    let chosen = |slug: &str| only.as_deref().is_none_or(|only| only == slug);
    let explained: BTreeSet<Survivor> = known
        .survivor
        .into_iter()
        .filter(|survivor| chosen(&survivor.exercise))
        .map(|survivor| Survivor { why: String::new(), ..survivor })
        .collect();
    let mutants = listed();
    let mut found = BTreeSet::new();
    for exercise in EXERCISES.iter().filter(|exercise| chosen(exercise.slug)) {
        let file = PathBuf::from(format!("solutions/src/{}.rs", exercise.slug));
        let of: Vec<&Mutant> = mutants.iter().filter(|mutant| mutant.file == file).collect();
        found.extend(Program::of(exercise, &of).survivors());
    }
    let new: Vec<_> = found.difference(&explained).collect();
    let gone: Vec<_> = explained.difference(&found).collect();
    assert!(new.is_empty(), "these survive and are not explained: {new:#?}");
    assert!(gone.is_empty(), "these are explained and do not survive: {gone:#?}");
}

fn listed() -> Vec<Mutant> {
    let output = Command::new("cargo")
        .args(["mutants", "--list", "--json", "--package", "solutions"])
        .args(["--exclude", "solutions/src/misconceptions/**", "--exclude", "solutions/src/lib.rs"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a list of mutants")
}

/// The mutants of one exercise, as modules of a program.
struct Program<'a> {
    exercise: &'a Exercise,
    mutants: &'a [&'a Mutant],
    source: String,
    folder: PathBuf,
}

impl<'a> Program<'a> {
    fn of(exercise: &'a Exercise, mutants: &'a [&'a Mutant]) -> Self {
        let path = root().join("solutions/src").join(format!("{}.rs", exercise.slug));
        let source = fs::read_to_string(path).expect("a reference answer");
        let folder = root().join("target/mutants").join(exercise.slug);
        Self { exercise, mutants, source, folder }
    }

    /// Compiles the mutants that can be compiled, and asks each of them.
    fn survivors(&self) -> Vec<Survivor> {
        self.write();
        let mut all: BTreeSet<usize> = (0..self.mutants.len()).collect();
        while let Some(broken) = self.broken(&all) {
            all.retain(|index| !broken.contains(index));
        }
        let built = self.cargo("build").stderr(Stdio::inherit()).status().expect("cargo runs");
        assert!(built.success(), "the mutants of {} do not compile", self.exercise.slug);
        let survivors: Vec<Survivor> =
            all.iter().filter(|index| self.survives(**index)).map(|i| self.told(*i)).collect();
        println!(
            "{}: of {} mutants {} compile, {} survive",
            self.exercise.slug,
            self.mutants.len(),
            all.len(),
            survivors.len()
        );
        survivors
    }

    fn write(&self) {
        let source = self.folder.join("src");
        fs::create_dir_all(&source).expect("a folder");
        for (index, mutant) in self.mutants.iter().enumerate() {
            let text = replaced(&self.source, &mutant.span, &mutant.replacement);
            fs::write(source.join(format!("m{index}.rs")), text).expect("written");
        }
        let workspace = fs::read_to_string(root().join("Cargo.toml")).expect("the workspace");
        let profile = workspace.find("[profile.dev]").expect("a profile");
        let profile = &workspace[profile..];
        let root = root();
        let manifest = format!(
            "[package]\nname = \"mutants-{1}\"\nedition = \"2024\"\n[workspace]\n[dependencies]\n\
             nalgebra = {{ version = \"0.35\", default-features = false }}\n\
             book-tests = {{ path = \"{0}/tests\" }}\nvislam = {{ path = \"{0}/code\" }}\n\
             exercise-spec = {{ path = \"{0}/exercises/spec\" }}\n{profile}",
            root.display(),
            self.exercise.slug
        );
        fs::write(self.folder.join("Cargo.toml"), manifest).expect("written");
        fs::copy(root.join("Cargo.lock"), self.folder.join("Cargo.lock")).expect("copied");
    }

    /// A program of these mutants: it fails when the checks notice the one that it is asked for.
    fn write_main(&self, mutants: &BTreeSet<usize>) {
        let slug = self.exercise.slug;
        let (mut modules, mut arms) = (String::new(), String::new());
        for index in mutants {
            let functions: Vec<String> =
                self.exercise.functions.iter().map(|f| format!("{f}: m{index}::{f}")).collect();
            let _ = writeln!(modules, "mod m{index};");
            let _ = writeln!(arms, "{index} => Functions {{ {} }},", functions.join(", "));
        }
        let main = format!(
            "#![allow(warnings)]\n{modules}\
             use exercise_spec::{{answer::Native, {slug}::{{EXERCISE, Functions}}}};\n\
             fn main() {{\n\
             let index: usize = std::env::args().nth(1).unwrap().parse().unwrap();\n\
             let answer = Native(match index {{\n{arms}_ => unreachable!() }});\n\
             let hidden = book_tests::hidden_checks({slug:?}, 1).unwrap();\n\
             let noticed = (EXERCISE.checks)().into_iter().chain(hidden)\
             .any(|check| check.run(&answer).is_err());\n\
             std::process::exit(i32::from(noticed));\n}}\n"
        );
        fs::write(self.folder.join("src/main.rs"), main).expect("written");
    }

    /// Those of the mutants that do not compile, if any.
    fn broken(&self, mutants: &BTreeSet<usize>) -> Option<BTreeSet<usize>> {
        self.write_main(mutants);
        let output =
            self.cargo("check").args(["--message-format", "json"]).output().expect("cargo");
        if output.status.success() {
            return None;
        }
        let mut broken = BTreeSet::new();
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            let message: serde_json::Value = serde_json::from_str(line).unwrap_or_default();
            let message = &message["message"];
            for span in message["spans"].as_array().into_iter().flatten() {
                let file = span["file_name"].as_str().unwrap_or_default();
                let index = file.strip_prefix("src/m").and_then(|file| file.strip_suffix(".rs"));
                if message["level"] == "error" && span["is_primary"] == true {
                    broken.extend(index.and_then(|index| index.parse::<usize>().ok()));
                }
            }
        }
        assert!(!broken.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(broken)
    }

    fn cargo(&self, command: &str) -> Command {
        let mut cargo = Command::new("cargo");
        cargo.arg(command).current_dir(&self.folder);
        cargo.env("CARGO_TARGET_DIR", root().join("target"));
        cargo
    }

    fn survives(&self, index: usize) -> bool {
        let mut child = Command::new("sh")
            .args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\" \"$1\"")])
            .arg(root().join(format!("target/debug/mutants-{}", self.exercise.slug)))
            .arg(index.to_string())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program runs");
        let begun = Instant::now();
        loop {
            if let Some(status) = child.try_wait().expect("a status") {
                return status.success();
            }
            if begun.elapsed() > PATIENCE {
                child.kill().and_then(|()| child.wait()).expect("ended");
                return false;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn told(&self, index: usize) -> Survivor {
        let mutant = self.mutants[index];
        let line = self.source.lines().nth(mutant.span.start.line - 1).unwrap_or_default();
        let change = mutant.name.split_once(": ").map_or(&*mutant.name, |(_, change)| change);
        Survivor {
            exercise: self.exercise.slug.to_owned(),
            change: change.to_owned(),
            line: line.trim().to_owned(),
            why: String::new(),
        }
    }
}

/// The text with a span of it replaced.
fn replaced(text: &str, span: &Span, replacement: &str) -> String {
    let at = |place: &Place| {
        let before: usize = text.split_inclusive('\n').take(place.line - 1).map(str::len).sum();
        let columns = text[before..].chars().take(place.column - 1).map(char::len_utf8);
        before + columns.sum::<usize>()
    };
    format!("{}{replacement}{}", &text[..at(&span.start)], &text[at(&span.end)..])
}
