//! `exercises/src/{name}.rs` for the browser.

#[path = "../../src/{name}.rs"]
mod answer;

exercise_pictures::picture!(Beside of {name}: doubled);
