//! `cargo test -p exercises nees_diagnosis`

#[path = "../src/nees_diagnosis.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::nees_diagnosis::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions =
        Functions { parts_of: answer::parts_of, band: answer::band, diagnosis: answer::diagnosis };
    exercise_runner::judge(&EXERCISE, include_str!("../src/nees_diagnosis.rs"), functions)
}
