//! Which way is down. Edition 1.
//!
//! `cargo test -p exercises align_gravity`

use exercise_spec::align_gravity::{Fit, Known, Solution, View};
use nalgebra::{Matrix6, Rotation3, Vector3};

/// The rotation that takes body coordinates to world coordinates, for a body at rest. The world's
/// third axis points up. `force` is the mean that the accelerometer reads, in the body and in
/// m/s²; its bias is not known and counts as zero. Seen from above, the body's first axis points
/// `heading` radians away from the world's first axis, towards the second one. The body's first axis
/// is never vertical. Otherwise the body may stand as it likes, upside down too.
pub fn level(force: Vector3<f64>, heading: f64) -> Rotation3<f64> {
    let _ = (force, heading);
    todo!("where does the mean force point, and where the first axis, seen from above?")
}

/// The joint covariance of tilt and bias that a stand leaves, as in `Known`, to first order.
///
/// The body was leveled. Before the stand, the bias was zero on average and had on each axis of
/// the body a standard deviation of its own, `bias_sigma`, in m/s² and none of them zero; nothing
/// was known of the tilt. The mean force has noise of standard deviation `noise_sigma` on each
/// axis, in m/s², which may be zero. All of these are independent. The heading was chosen and
/// counts as exact, so φ has no part about the vertical. Gravity has a known size, in m/s²: the
/// direction of the mean force says something, and so does its length.
pub fn rest_covariance(
    world_from_body: Rotation3<f64>,
    bias_sigma: Vector3<f64>,
    noise_sigma: f64,
    gravity: f64,
) -> Matrix6<f64> {
    let _ = (world_from_body, bias_sigma, noise_sigma, gravity);
    todo!("what do the direction and the length of the mean force leave open of tilt and bias?")
}

/// The most likely φ of the first stand, and the most likely bias, once the body has stood
/// a second time, to first order in what was not known. In between it was turned by a rotation
/// that is known exactly; `first_from_second` takes coordinates of the body as it stands now to
/// those of the body as it stood before. The bias belongs to the sensor and has stayed the
/// same. `force` is the new mean, in the body as it stands now, with new noise of standard
/// deviation `noise_sigma` on each axis, which is not zero.
pub fn second_stand(
    known: Known,
    first_from_second: Rotation3<f64>,
    force: Vector3<f64>,
    noise_sigma: f64,
    gravity: f64,
) -> (Vector3<f64>, Vector3<f64>) {
    let _ = (known, first_from_second, force, noise_sigma, gravity);
    todo!("how would a small tilt and a small bias show in the second mean force?")
}

/// Velocity and gravity that fit best when a unit of the motion is `scale` metres. The residual of
/// each view but the first is the left side of the book's equation less its right side,
///
/// scale (c − c₀) − t v − ½ t² g − A − (R − R₀) l,
///
/// where t, c₀ and R₀ are counted from and taken at the first view, A is the force integrated
/// twice, and l is the camera's place in the body, in metres (`lever`). What is noisy are the
/// centres alone, so each coordinate of it has a standard deviation of `scale` times the view's
/// `sigma`. The length of g is `gravity`, in m/s². There are five views or more, in the order of
/// time, and the scale is positive.
pub fn at_scale(views: Vec<View>, lever: Vector3<f64>, gravity: f64, scale: f64) -> Fit {
    let _ = (views, lever, gravity, scale);
    todo!("the best velocity and gravity while the scale is held")
}

/// All scales that the views allow, the smallest first; none when the views do not say how large
/// the motion is.
///
/// A scale is a candidate where `squares` of `at_scale` is less than at all other scales near
/// it. The least of these squares is the best. A candidate is allowed when its squares are more
/// than that by `gate` at most. There are two allowed scales at the most.
///
/// The `sigma` of a solution is the standard deviation of its scale over the scale, to first
/// order: from the inverse of JᵀJ, where J holds the derivatives of the quotients, residual over
/// standard deviation (the scale is in both), by scale, velocity and two directions in which
/// gravity moves on its sphere. When that is more than `most` for any allowed scale, all are refused.
pub fn scales(
    views: Vec<View>,
    lever: Vector3<f64>,
    gravity: f64,
    most: f64,
    gate: f64,
) -> Vec<Solution> {
    let _ = (views, lever, gravity, most, gate);
    todo!("all scales at which everything fits, how well each is known, and whether that is enough")
}
