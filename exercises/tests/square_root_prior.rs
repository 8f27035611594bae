//! `cargo test -p exercises square_root_prior`

#[path = "../src/square_root_prior.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::square_root_prior::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions =
        Functions { absorb: answer::absorb, slide: answer::slide, seen_from: answer::seen_from };
    exercise_runner::judge(&EXERCISE, include_str!("../src/square_root_prior.rs"), functions)
}
