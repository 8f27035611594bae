//! `cargo test -p exercises robust_motion`

#[path = "../src/robust_motion.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::robust_motion::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        draws: answer::draws,
        squared_errors: answer::squared_errors,
        score: answer::score,
        false_alarms: answer::false_alarms,
        chosen_motion: answer::chosen_motion,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/robust_motion.rs"), functions)
}
