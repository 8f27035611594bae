//! `cargo test -p exercises along_or_across`

#[path = "../src/along_or_across.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::along_or_across::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        drag_along: answer::drag_along,
        drag_across: answer::drag_across,
        predicted_moves: answer::predicted_moves,
        exact_moves: answer::exact_moves,
        least_noticed_drag: answer::least_noticed_drag,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/along_or_across.rs"), functions)
}
