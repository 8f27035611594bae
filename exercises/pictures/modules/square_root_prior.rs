//! `exercises/src/square_root_prior.rs` for the browser.

#[path = "../../src/square_root_prior.rs"]
mod answer;

exercise_pictures::picture!(Beside of square_root_prior: absorb, slide, seen_from);
