//! `cargo test -p exercises noise_growth`

#[path = "../src/noise_growth.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::noise_growth::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        error_step: answer::error_step,
        next_covariance: answer::next_covariance,
        covariance_of: answer::covariance_of,
        predicted_exponents: answer::predicted_exponents,
        fitted_exponent: answer::fitted_exponent,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/noise_growth.rs"), functions)
}
