//! `cargo test -p exercises stereo_gauge`

#[path = "../src/stereo_gauge.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::stereo_gauge::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        right_from_world: answer::right_from_world,
        right_blocks: answer::right_blocks,
        reduced_system: answer::reduced_system,
        stiffnesses: answer::stiffnesses,
        rigid_motions: answer::rigid_motions,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/stereo_gauge.rs"), functions)
}
