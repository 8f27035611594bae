//! Wrong answers to [`left_perturbation`](crate::left_perturbation).

use exercise_spec::left_perturbation::*;
use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, Point3, Translation3, Vector2, Vector3, Vector6};
use vislam::manifold::{se3, so3};

use super::Wrong;
use crate::left_perturbation as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    left_pose_jacobian: right::left_pose_jacobian,
    right_from_left: right::right_from_left,
    central_differences: right::central_differences,
    forward_motion: right::forward_motion,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let jacobian = |misconception, left_pose_jacobian| {
        Wrong::new(misconception, Functions { left_pose_jacobian, ..REFERENCE })
    };
    let dictionary = |misconception, right_from_left| {
        Wrong::new(misconception, Functions { right_from_left, ..REFERENCE })
    };
    let differences = |misconception, central_differences| {
        Wrong::new(misconception, Functions { central_differences, ..REFERENCE })
    };
    vec![
        jacobian(&RIGHT_PERTURBATION, |camera, pose, point| {
            right::right_from_left(pose, right::left_pose_jacobian(camera, pose, point))
        }),
        jacobian(&POINT_IN_WORLD, |camera, pose, point| {
            let projection = projection(&camera, &pose, &point);
            blocks(&projection, &(-projection * so3::hat(&point)))
        }),
        jacobian(&ROTATION_KEPT, |camera, pose, point| {
            let turned = projection(&camera, &pose, &point) * pose.rotation.to_rotation_matrix();
            blocks(&turned, &(-turned * so3::hat(&(pose * Point3::from(point)).coords)))
        }),
        jacobian(&TRANSLATION_TURNED, |camera, pose, point| {
            let turned = projection(&camera, &pose, &point) * pose.rotation.to_rotation_matrix();
            let jacobian = right::left_pose_jacobian(camera, pose, point);
            blocks(&turned, &jacobian.fixed_columns::<3>(3).into())
        }),
        jacobian(&SKEW_SIGN, |camera, pose, point| {
            let mut jacobian = right::left_pose_jacobian(camera, pose, point);
            jacobian.fixed_columns_mut::<3>(3).neg_mut();
            jacobian
        }),
        jacobian(&ALL_NEGATED, |camera, pose, point| {
            -right::left_pose_jacobian(camera, pose, point)
        }),
        jacobian(&TRANSLATION_FORGOTTEN, |camera, pose, point| {
            let turn = Isometry3::from_parts(Translation3::identity(), pose.rotation);
            right::left_pose_jacobian(camera, turn, point)
        }),
        jacobian(&TRANSLATION_FORGOTTEN, |camera, pose, point| {
            let projection = projection(&camera, &pose, &point);
            blocks(&projection, &(-projection * so3::hat(&(pose.rotation * point))))
        }),
        jacobian(&SLOPE_AT_WORLD_POINT, |camera, pose, point| {
            let slope = projection(&camera, &Isometry3::identity(), &point);
            blocks(&slope, &(-slope * so3::hat(&(pose * Point3::from(point)).coords)))
        }),
        jacobian(&SLOPE_AT_WORLD_POINT, |camera, _, point| {
            right::left_pose_jacobian(camera, Isometry3::identity(), point)
        }),
        jacobian(&FOCAL_LENGTH_MISSING, |camera, pose, point| {
            right::left_pose_jacobian(Camera { fx: 1.0, fy: 1.0, ..camera }, pose, point)
        }),
        Wrong::new(
            &FOCAL_LENGTH_MISSING,
            Functions {
                forward_motion: |camera, point| {
                    right::forward_motion(Camera { fx: 1.0, fy: 1.0, ..camera }, point)
                },
                ..REFERENCE
            },
        ),
        jacobian(&ROTATION_FIRST, |camera, pose, point| {
            let jacobian = right::left_pose_jacobian(camera, pose, point);
            blocks(&jacobian.fixed_columns::<3>(3).into(), &jacobian.fixed_columns::<3>(0).into())
        }),
        dictionary(&TRANSPOSED_ADJOINT, |pose, left| left * se3::adjoint(&pose).transpose()),
        dictionary(&INVERSE_ADJOINT, |pose, left| left * se3::adjoint(&pose.inverse())),
        differences(&ONE_SIDED, |camera, pose, point, side, step| {
            let pixel = |axis: Option<usize>| {
                let xi = Vector6::from_fn(|row, _| if Some(row) == axis { step } else { 0.0 });
                let moved = match side {
                    Side::Left => se3::exp(&xi) * pose,
                    Side::Right => pose * se3::exp(&xi),
                };
                camera.pinhole().project(&moved, &point).unwrap_or_default()
            };
            let columns = [0, 1, 2, 3, 4, 5].map(|axis| (pixel(Some(axis)) - pixel(None)) / step);
            Matrix2x6::from_columns(&columns)
        }),
        differences(&TWIST_NOT_APPLIED, |camera, pose, point, _, step| {
            let pixel = || camera.pinhole().project(&pose, &point).unwrap_or_default();
            let difference = (pixel() - pixel()) / (2.0 * step);
            Matrix2x6::from_columns(&[difference; 6])
        }),
        differences(&TWICE_TOO_LARGE, |camera, pose, point, side, step| {
            2.0 * right::central_differences(camera, pose, point, side, step)
        }),
        differences(&SIDES_EXCHANGED, |camera, pose, point, side, step| {
            let other = match side {
                Side::Left => Side::Right,
                Side::Right => Side::Left,
            };
            right::central_differences(camera, pose, point, other, step)
        }),
        jacobian(&DIFFERENCED, |camera, pose, point| {
            differenced(|axis, step| {
                let xi = Vector6::ith(axis, step);
                camera.pinhole().project(&(se3::exp(&xi) * pose), &point).unwrap_or_default()
            })
        }),
        jacobian(&DIFFERENCED, |camera, pose, point| {
            let point = pose * Point3::from(point);
            differenced(|axis, step| {
                let moved = se3::exp(&Vector6::ith(axis, step * point.z)) * point;
                Vector2::new(camera.fx * moved.x, camera.fy * moved.y) / (moved.z * point.z)
            })
        }),
        Wrong::new(
            &DIFFERENCED,
            Functions {
                forward_motion: |camera, point| {
                    let moved = |axis: usize, step: f64| {
                        let forward = Vector3::ith(2, if axis == 2 { -step } else { 0.0 });
                        camera.pinhole().project_cam(&(point + forward)).unwrap_or_default()
                    };
                    differenced(moved).column(2).into_owned()
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &POINT_MOVES,
            Functions {
                forward_motion: |camera, point| -right::forward_motion(camera, point),
                ..REFERENCE
            },
        ),
    ]
}

/// Differences of the fourth order along the axes of a twist.
fn differenced(pixel: impl Fn(usize, f64) -> Vector2<f64>) -> Matrix2x6<f64> {
    const H: f64 = 2e-4;
    Matrix2x6::from_columns(&[0, 1, 2, 3, 4, 5].map(|axis| {
        let near = pixel(axis, H) - pixel(axis, -H);
        let far = pixel(axis, 2.0 * H) - pixel(axis, -2.0 * H);
        (8.0 * near - far) / (12.0 * H)
    }))
}

fn projection(camera: &Camera, pose: &Isometry3<f64>, point: &Vector3<f64>) -> Matrix2x3<f64> {
    let point_in_camera = (pose * Point3::from(*point)).coords;
    camera.pinhole().projection_jacobian(&point_in_camera).unwrap_or_default()
}

fn blocks(translation: &Matrix2x3<f64>, rotation: &Matrix2x3<f64>) -> Matrix2x6<f64> {
    let mut jacobian = Matrix2x6::zeros();
    jacobian.fixed_columns_mut::<3>(0).copy_from(translation);
    jacobian.fixed_columns_mut::<3>(3).copy_from(rotation);
    jacobian
}
