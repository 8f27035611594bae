//! `cargo test -p exercises null_space`

#[path = "../src/null_space.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::null_space::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        givens: answer::givens,
        project_out: answer::project_out,
        correction: answer::correction,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/null_space.rs"), functions)
}
