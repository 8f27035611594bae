//! Two views reduced to three numbers: two distances and the angle between them.

// ANCHOR: ray_sigma
/// Standard deviation, in metres, of a point along the ray of the first camera.
///
/// The point lies `first_distance` and `second_distance` metres from the two centres, its
/// rays meet at the angle `parallax`, and each camera measures directions with the standard
/// deviation `angular_sigma`; angles are in radians. Implements {eq:ray-sigma}.
pub fn ray_sigma(
    first_distance: f64,
    second_distance: f64,
    parallax: f64,
    angular_sigma: f64,
) -> f64 {
    angular_sigma * second_distance.hypot(first_distance * parallax.cos()) / parallax.sin()
}
// ANCHOR_END: ray_sigma

// ANCHOR: point_condition
/// Condition number of the information about a point that two cameras see from equal
/// distances at an angle of `parallax` radians, at most a right angle.
///
/// Implements {eq:point-condition}.
pub fn point_condition(parallax: f64) -> f64 {
    (0.5 * parallax).sin().powi(-2)
}
// ANCHOR_END: point_condition

// ANCHOR: depth_bias
/// By how many metres a depth computed from a disparity is too large on average, to leading
/// order.
///
/// Implements {eq:depth-bias}.
pub fn depth_bias(depth: f64, depth_sigma: f64) -> f64 {
    depth_sigma * depth_sigma / depth
}
// ANCHOR_END: depth_bias
