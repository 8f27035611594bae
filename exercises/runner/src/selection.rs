//! Which exercises a word on the command line means, and how they are run.

use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use exercise_spec::{EXERCISES, Exercise};

/// The exercises that a filter of `cargo test` selects: the one of that name, and if there is
/// none, those whose name contains it or who have a check whose name does.
pub fn selected(filter: Option<&str>) -> Vec<&'static Exercise> {
    let Some(filter) = filter else { return EXERCISES.to_vec() };
    if let Some(exact) = exercise_spec::exercise(filter) {
        return vec![exact];
    }
    let has = |exercise: &&&Exercise| {
        exercise.slug.contains(filter)
            || (exercise.checks)()
                .iter()
                .any(|check| format!("{}::{}", exercise.slug, check.name).contains(filter))
    };
    EXERCISES.iter().filter(has).copied().collect()
}

/// The exercise of a name.
///
/// # Errors
///
/// A sentence with the names there are.
pub fn named(slug: &str) -> Result<&'static Exercise, String> {
    exercise_spec::exercise(slug).ok_or_else(|| unknown(slug))
}

/// A sentence with the names there are.
pub fn unknown(name: &str) -> String {
    let all: Vec<&str> = EXERCISES.iter().map(|exercise| exercise.slug).collect();
    format!("there is no exercise `{name}`; there is {}", all.join(", "))
}

/// Compiles one answer and runs its checks, with more arguments for them. Nothing comes back
/// when it does not compile; the compiler has said why.
///
/// # Errors
///
/// When cargo or the compiled tests cannot be started.
pub fn run(folder: &Path, slug: &str, arguments: &[String]) -> Result<Option<ExitStatus>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let compiled = Command::new(cargo)
        .args(["test", "--quiet", "--offline", "--package", "exercises", "--test", slug])
        .args(["--no-run", "--message-format", "json-render-diagnostics"])
        .current_dir(folder)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cannot start cargo: {error}"))?;
    if !compiled.status.success() {
        return Ok(None);
    }
    let messages = String::from_utf8_lossy(&compiled.stdout);
    let program = messages.lines().find_map(|line| program(line, slug));
    let program =
        program.ok_or_else(|| format!("cargo does not say where the tests of {slug} are"))?;
    Command::new(&program)
        .args(arguments)
        .current_dir(folder)
        .status()
        .map(Some)
        .map_err(|error| format!("cannot start {program}: {error}"))
}

/// The program of a test target, when a message of cargo names it.
fn program(message: &str, slug: &str) -> Option<String> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    (message["target"]["name"] == slug).then_some(())?;
    Some(message["executable"].as_str()?.to_owned())
}

/// Text in lines of at most `width` characters. Empty lines divide paragraphs.
pub fn wrapped(text: &str, width: usize) -> String {
    let paragraph = |paragraph: &str| {
        let mut lines = vec![String::new()];
        for word in paragraph.split_whitespace() {
            let line = lines.last().map_or(0, |line| line.chars().count());
            if line > 0 && line + 1 + word.chars().count() > width {
                lines.push(String::new());
            }
            if let Some(line) = lines.last_mut() {
                if !line.is_empty() {
                    line.push(' ');
                }
                line.push_str(word);
            }
        }
        lines.join("\n")
    };
    text.split("\n\n").map(paragraph).collect::<Vec<_>>().join("\n\n")
}
