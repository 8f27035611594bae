//! `cargo test -p exercises {name}`

#[path = "../src/{name}.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::{name}::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions { doubled: answer::doubled };
    exercise_runner::judge(&EXERCISE, include_str!("../src/{name}.rs"), functions)
}
