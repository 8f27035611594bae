//! `exercises/src/scale_and_gravity.rs` for the browser.

#[path = "../../src/scale_and_gravity.rs"]
mod answer;

exercise_pictures::picture!(Beside of scale_and_gravity: scaled_window, split_residual, scale_is_free);
