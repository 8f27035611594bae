//! Worked examples of robust two-view geometry: minimal solvers, consensus, and which model.

#[path = "robust_two_view/scenes.rs"]
mod scenes;
#[path = "robust_two_view/five_points.rs"]
mod five_points;
