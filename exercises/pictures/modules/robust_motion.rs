//! `exercises/src/robust_motion.rs` for the browser.

#[path = "../../src/robust_motion.rs"]
mod answer;

exercise_pictures::picture!(Beside of robust_motion: draws, squared_errors, score, false_alarms, chosen_motion);
