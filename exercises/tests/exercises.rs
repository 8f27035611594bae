//! `cargo test -p exercises NAME` compiles and runs the answers it selects, one by one: an answer
//! that does not compile blocks only itself.

use std::process::ExitCode;

use exercise_runner::{folder::Folder, selection};
use libtest_mimic::Arguments;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let selected = selection::selected(arguments.filter.as_deref());
    if arguments.list {
        for exercise in &selected {
            for check in (exercise.checks)() {
                println!("{}::{}: test", exercise.slug, check.name);
            }
        }
        return ExitCode::SUCCESS;
    }
    if selected.is_empty() {
        eprintln!("{}", selection::unknown(arguments.filter.as_deref().unwrap_or_default()));
        return ExitCode::from(2);
    }
    let passed_on: Vec<String> = std::env::args().skip(1).collect();
    let mut failed = Vec::new();
    for exercise in selected {
        println!("\n{}: {}", exercise.slug, exercise.title);
        match selection::run(Folder::here().path(), exercise.slug, &passed_on) {
            Ok(Some(status)) if status.success() => {}
            Ok(Some(_)) => failed.push(exercise.slug),
            Ok(None) => {
                println!("{} does not compile; the compiler says why above", exercise.slug);
                failed.push(exercise.slug);
            }
            Err(error) => {
                eprintln!("{error}");
                return ExitCode::from(2);
            }
        }
    }
    if failed.is_empty() {
        return ExitCode::SUCCESS;
    }
    println!("not solved yet: {}", failed.join(", "));
    ExitCode::FAILURE
}
