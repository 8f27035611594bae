//! `exercises/src/left_perturbation.rs` for the browser.

#[path = "../../src/left_perturbation.rs"]
mod answer;

exercise_pictures::picture!(LeftPerturbation of left_perturbation: left_pose_jacobian, right_from_left, central_differences, forward_motion);
