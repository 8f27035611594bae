//! `cargo test -p exercises align_gravity`

#[path = "../src/align_gravity.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::align_gravity::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        level: answer::level,
        rest_covariance: answer::rest_covariance,
        second_stand: answer::second_stand,
        at_scale: answer::at_scale,
        scales: answer::scales,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/align_gravity.rs"), functions)
}
