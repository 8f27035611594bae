//! `cargo test -p exercises residual_jacobian`

#[path = "../src/residual_jacobian.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::residual_jacobian::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        residual: answer::residual,
        by_first: answer::by_first,
        by_world_steps: answer::by_world_steps,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/residual_jacobian.rs"), functions)
}
