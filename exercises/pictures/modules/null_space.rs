//! `exercises/src/null_space.rs` for the browser.

#[path = "../../src/null_space.rs"]
mod answer;

exercise_pictures::picture!(Beside of null_space: givens, project_out, correction);
