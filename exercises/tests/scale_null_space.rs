//! `cargo test -p exercises scale_null_space`

#[path = "../src/scale_null_space.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::scale_null_space::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        rescaled: answer::rescaled,
        scale_direction: answer::scale_direction,
        annihilation: answer::annihilation,
        with_distance_held: answer::with_distance_held,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/scale_null_space.rs"), functions)
}
