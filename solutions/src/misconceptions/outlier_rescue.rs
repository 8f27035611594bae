//! Wrong answers to [`outlier_rescue`](crate::outlier_rescue).

use exercise_spec::outlier_rescue::*;
use nalgebra::{Isometry3, Matrix2, Matrix6, Vector2, Vector6};
use vislam::manifold::se3;

use super::Wrong;
use crate::outlier_rescue as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    huber_weight: right::huber_weight,
    robust_step: right::robust_step,
    robust_pose: right::robust_pose,
    rmse_of_right: right::rmse_of_right,
};

/// A wrong answer whose weights are those of a function, on their own and in the step.
macro_rules! weighted {
    ($misconception:ident, $weight:expr) => {
        Wrong::new(
            &$misconception,
            Functions {
                huber_weight: $weight,
                robust_step: |camera, pose, matches, threshold| {
                    step(camera, pose, &matches, |residual, covariance| {
                        let weight: fn(Vector2<f64>, Matrix2<f64>, f64) -> f64 = $weight;
                        let weighted =
                            weight(residual, covariance, threshold) * inverse(covariance);
                        [weighted, weighted]
                    })
                },
                ..REFERENCE
            },
        )
    };
}

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let step_is = |misconception, robust_step| {
        Wrong::new(misconception, Functions { robust_step, ..REFERENCE })
    };
    let pose_is = |misconception, robust_pose| {
        Wrong::new(misconception, Functions { robust_pose, ..REFERENCE })
    };
    let rmse_is = |misconception, rmse_of_right| {
        Wrong::new(misconception, Functions { rmse_of_right, ..REFERENCE })
    };
    vec![
        weighted!(UNWHITENED, |residual, _, threshold| {
            right::huber_weight(residual, Matrix2::identity(), threshold)
        }),
        weighted!(SQUARED_NORM, |residual, covariance, threshold| {
            (threshold / deviations(residual, covariance).powi(2)).min(1.0)
        }),
        weighted!(INFLUENCE, |residual, covariance, threshold| {
            deviations(residual, covariance).min(threshold)
        }),
        weighted!(AXES_IGNORED, |residual, covariance, threshold| {
            let diagonal = Matrix2::from_diagonal(&covariance.diagonal());
            right::huber_weight(residual, diagonal, threshold)
        }),
        weighted!(DEVIATIONS_MULTIPLIED, |residual, covariance, threshold| {
            let lower = covariance.cholesky().map_or_else(Matrix2::zeros, |factor| factor.l());
            right::huber_weight(lower * residual, Matrix2::identity(), threshold)
        }),
        weighted!(HARD_REJECTION, |residual, covariance, threshold| {
            if deviations(residual, covariance) > threshold { 0.0 } else { 1.0 }
        }),
        weighted!(ROOT_OF_WEIGHT, |residual, covariance, threshold| {
            right::huber_weight(residual, covariance, threshold).sqrt()
        }),
        step_is(&WEIGHT_TWICE, |camera, pose, matches, threshold| {
            step(camera, pose, &matches, |residual, covariance| {
                let weight = right::huber_weight(residual, covariance, threshold);
                [weight * weight * inverse(covariance); 2]
            })
        }),
        step_is(&RESIDUAL_ALONE, |camera, pose, matches, threshold| {
            step(camera, pose, &matches, |residual, covariance| {
                let weight = right::huber_weight(residual, covariance, threshold);
                [inverse(covariance), weight.sqrt() * inverse(covariance)]
            })
        }),
        step_is(&MATRIX_ALONE, |camera, pose, matches, threshold| {
            step(camera, pose, &matches, |residual, covariance| {
                let weight = right::huber_weight(residual, covariance, threshold);
                [weight * inverse(covariance), inverse(covariance)]
            })
        }),
        step_is(&ROWS_IN_PIXELS, |camera, pose, matches, threshold| {
            step(camera, pose, &matches, |residual, covariance| {
                let weight = right::huber_weight(residual, covariance, threshold);
                [weight * Matrix2::identity(); 2]
            })
        }),
        step_is(&UPHILL, |camera, pose, matches, threshold| {
            -right::robust_step(camera, pose, matches, threshold)
        }),
        step_is(&LEFT_TWIST, |camera, pose, matches, threshold| {
            se3::adjoint(&pose) * right::robust_step(camera, pose, matches, threshold)
        }),
        pose_is(&ONE_STEP, |camera, start, matches, threshold| {
            se3::retract(&start, &right::robust_step(camera, start, matches, threshold))
        }),
        pose_is(&FROZEN_WEIGHTS, |camera, start, mut matches, threshold| {
            for seen in &mut matches {
                let pixel = camera.pinhole().project(&start, &seen.point_in_world);
                let residual = pixel.unwrap_or_default() - seen.pixel;
                seen.covariance /= right::huber_weight(residual, seen.covariance, threshold);
            }
            right::robust_pose(camera, start, matches, f64::INFINITY)
        }),
        rmse_is(&RMSE_OVER_ALL, |camera, pose, matches, right| {
            right::rmse_of_right(camera, pose, matches, vec![true; right.len()])
        }),
        rmse_is(&RMSE_PER_MATCH, |camera, pose, matches, right| {
            2.0_f64.sqrt() * right::rmse_of_right(camera, pose, matches, right)
        }),
        rmse_is(&MEAN_SQUARE, |camera, pose, matches, right| {
            right::rmse_of_right(camera, pose, matches, right).powi(2)
        }),
        rmse_is(&RMSE_WHITENED, |camera, pose, matches, right| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (seen, _) in matches.iter().zip(right).filter(|(_, right)| *right) {
                let pixel = camera.pinhole().project(&pose, &seen.point_in_world);
                let residual = pixel.unwrap_or_default() - seen.pixel;
                sum += deviations(residual, seen.covariance).powi(2);
                count += 2.0;
            }
            f64::sqrt(sum / count)
        }),
    ]
}

/// A step whose matrix and gradient take what stands for each match's weighted information.
fn step(
    camera: Camera,
    pose: Isometry3<f64>,
    matches: &[Match],
    information: impl Fn(Vector2<f64>, Matrix2<f64>) -> [Matrix2<f64>; 2],
) -> Vector6<f64> {
    let (mut hessian, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
    for seen in matches {
        let Some(predicted) = camera.pinhole().project_with_jacobians(&pose, &seen.point_in_world)
        else {
            continue;
        };
        let residual = predicted.pixel - seen.pixel;
        let [of_hessian, of_gradient] = information(residual, seen.covariance);
        hessian += predicted.by_pose.transpose() * of_hessian * predicted.by_pose;
        gradient += predicted.by_pose.transpose() * of_gradient * residual;
    }
    hessian.cholesky().map_or_else(Vector6::zeros, |factor| -factor.solve(&gradient))
}

fn inverse(covariance: Matrix2<f64>) -> Matrix2<f64> {
    covariance.try_inverse().unwrap_or_default()
}

fn deviations(residual: Vector2<f64>, covariance: Matrix2<f64>) -> f64 {
    residual.dot(&(inverse(covariance) * residual)).sqrt()
}
