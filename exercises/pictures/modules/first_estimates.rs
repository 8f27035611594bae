//! `exercises/src/first_estimates.rs` for the browser.

#[path = "../../src/first_estimates.rs"]
mod answer;

exercise_pictures::picture!(Beside of first_estimates: free_directions, linearized, one_trajectory, lost, restored);
