//! `exercises/src/align_gravity.rs` for the browser.

#[path = "../../src/align_gravity.rs"]
mod answer;

exercise_pictures::picture!(Beside of align_gravity: level, rest_covariance, second_stand, at_scale, scales);
