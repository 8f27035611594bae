//! Worked examples of robust two-view geometry: minimal solvers, consensus, and which model.

#[path = "robust_two_view/scenes.rs"]
mod scenes;

#[path = "robust_two_view/five_points.rs"]
mod five_points;

#[path = "robust_two_view/linear.rs"]
mod linear;

#[path = "robust_two_view/errors.rs"]
mod errors;

#[path = "robust_two_view/agreement.rs"]
mod agreement;

#[path = "robust_two_view/which_model.rs"]
mod which_model;

#[path = "robust_two_view/resection.rs"]
mod resection;
