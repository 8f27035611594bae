//! `cargo test -p exercises scale_and_gravity`

#[path = "../src/scale_and_gravity.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::scale_and_gravity::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        scaled_window: answer::scaled_window,
        split_residual: answer::split_residual,
        scale_is_free: answer::scale_is_free,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/scale_and_gravity.rs"), functions)
}
