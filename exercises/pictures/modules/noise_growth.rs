//! `exercises/src/noise_growth.rs` for the browser.

#[path = "../../src/noise_growth.rs"]
mod answer;

exercise_pictures::picture!(Beside of noise_growth: error_step, next_covariance, covariance_of, predicted_exponents, fitted_exponent);
