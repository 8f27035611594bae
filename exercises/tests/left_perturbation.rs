//! `cargo test -p exercises left_perturbation`

#[path = "../src/left_perturbation.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::left_perturbation::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        left_pose_jacobian: answer::left_pose_jacobian,
        right_from_left: answer::right_from_left,
        central_differences: answer::central_differences,
        forward_motion: answer::forward_motion,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/left_perturbation.rs"), functions)
}
