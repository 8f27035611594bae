//! `cargo test -p exercises outlier_rescue`

#[path = "../src/outlier_rescue.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::outlier_rescue::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        huber_weight: answer::huber_weight,
        robust_step: answer::robust_step,
        robust_pose: answer::robust_pose,
        rmse_of_right: answer::rmse_of_right,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/outlier_rescue.rs"), functions)
}
