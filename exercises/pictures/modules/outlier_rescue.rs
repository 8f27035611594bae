//! `exercises/src/outlier_rescue.rs` for the browser.

#[path = "../../src/outlier_rescue.rs"]
mod answer;

exercise_pictures::picture!(Beside of outlier_rescue: huber_weight, robust_step, robust_pose, rmse_of_right);
