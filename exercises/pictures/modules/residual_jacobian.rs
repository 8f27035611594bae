//! `exercises/src/residual_jacobian.rs` for the browser.

#[path = "../../src/residual_jacobian.rs"]
mod answer;

exercise_pictures::picture!(ResidualJacobian of residual_jacobian: residual, by_first, by_world_steps);
