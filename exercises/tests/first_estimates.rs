//! `cargo test -p exercises first_estimates`

#[path = "../src/first_estimates.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::first_estimates::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        free_directions: answer::free_directions,
        linearized: answer::linearized,
        one_trajectory: answer::one_trajectory,
        lost: answer::lost,
        restored: answer::restored,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/first_estimates.rs"), functions)
}
