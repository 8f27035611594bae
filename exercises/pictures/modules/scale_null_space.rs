//! `exercises/src/scale_null_space.rs` for the browser.

#[path = "../../src/scale_null_space.rs"]
mod answer;

exercise_pictures::picture!(Beside of scale_null_space: rescaled, scale_direction, annihilation, with_distance_held);
