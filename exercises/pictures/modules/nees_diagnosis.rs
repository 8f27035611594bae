//! `exercises/src/nees_diagnosis.rs` for the browser.

#[path = "../../src/nees_diagnosis.rs"]
mod answer;

exercise_pictures::picture!(Beside of nees_diagnosis: parts_of, band, diagnosis);
