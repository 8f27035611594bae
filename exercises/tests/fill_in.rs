//! `cargo test -p exercises fill_in`

#[path = "../src/fill_in.rs"]
mod answer;

use std::process::ExitCode;

use exercise_spec::fill_in::{EXERCISE, Functions};

fn main() -> ExitCode {
    let functions = Functions {
        new_couplings: answer::new_couplings,
        information_lost: answer::information_lost,
        cheapest_link: answer::cheapest_link,
    };
    exercise_runner::judge(&EXERCISE, include_str!("../src/fill_in.rs"), functions)
}
