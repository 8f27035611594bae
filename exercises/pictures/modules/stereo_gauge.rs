//! `exercises/src/stereo_gauge.rs` for the browser.

#[path = "../../src/stereo_gauge.rs"]
mod answer;

exercise_pictures::picture!(Beside of stereo_gauge: right_from_world, right_blocks, reduced_system, stiffnesses, rigid_motions);
