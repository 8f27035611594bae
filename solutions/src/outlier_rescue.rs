//! A tenth of the matches is wrong.

use exercise_spec::outlier_rescue::{Camera, Match};
use nalgebra::{Isometry3, Matrix2, Matrix6, Vector2, Vector6};
use vislam::manifold::se3;

/// The weight w = ρ'(s)/s of Huber's kernel for a residual given in **pixels** with its
/// covariance in square pixels. s is the length of the whitened residual. The threshold
/// counts standard deviations and is positive; an infinite one gives every match the weight
/// one, and so does any threshold to a residual of zero.
pub fn huber_weight(residual: Vector2<f64>, covariance: Matrix2<f64>, threshold: f64) -> f64 {
    let information = covariance.try_inverse().unwrap_or_default();
    let deviations = residual.dot(&(information * residual)).sqrt();
    if deviations > threshold { threshold / deviations } else { 1.0 }
}

/// One reweighted Gauss-Newton step: the twist ξ = (ρ, φ), in metres and radians, to be
/// applied on the **right**, T exp(ξ). It is the minimum of the sum of weighted squares of
/// the whitened, linearized residuals, with the weights of the pose given. Every point is in
/// front of the camera, and the matches determine the pose.
pub fn robust_step(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    matches: Vec<Match>,
    threshold: f64,
) -> Vector6<f64> {
    let (mut hessian, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
    for seen in matches {
        let predicted =
            camera.pinhole().project_with_jacobians(&camera_from_world, &seen.point_in_world);
        let (Some(predicted), Some(information)) = (predicted, seen.covariance.try_inverse())
        else {
            continue;
        };
        let residual = predicted.pixel - seen.pixel;
        let weight = huber_weight(residual, seen.covariance, threshold);
        let weighted = predicted.by_pose.transpose() * (weight * information);
        hessian += weighted * predicted.by_pose;
        gradient += weighted * residual;
    }
    hessian.cholesky().map_or_else(Vector6::zeros, |factor| -factor.solve(&gradient))
}

/// The pose with the least sum of Huber's costs, near the pose to start from: steps until
/// the length of their six numbers is below 1e-10. An infinite threshold makes it the pose
/// of least squares.
pub fn robust_pose(
    camera: Camera,
    start: Isometry3<f64>,
    matches: Vec<Match>,
    threshold: f64,
) -> Isometry3<f64> {
    let mut pose = start;
    for _ in 0..200 {
        let step = robust_step(camera, pose, matches.clone(), threshold);
        pose = se3::retract(&pose, &step);
        if step.norm() < 1e-10 {
            break;
        }
    }
    pose
}

/// The root of the mean square of the residuals' **coordinates**, in pixels, over the right
/// matches: a match has two coordinates, and `right` says of each match whether it is right.
/// At least one is.
pub fn rmse_of_right(
    camera: Camera,
    camera_from_world: Isometry3<f64>,
    matches: Vec<Match>,
    right: Vec<bool>,
) -> f64 {
    let squares: Vec<f64> = matches
        .iter()
        .zip(right)
        .filter(|(_, right)| *right)
        .filter_map(|(seen, _)| {
            let pixel = camera.pinhole().project(&camera_from_world, &seen.point_in_world)?;
            Some((pixel - seen.pixel).norm_squared())
        })
        .collect();
    (squares.iter().sum::<f64>() / (2 * squares.len()) as f64).sqrt()
}
