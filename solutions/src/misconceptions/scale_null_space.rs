//! Wrong answers to [`scale_null_space`](crate::scale_null_space).

use exercise_spec::scale_null_space::*;
use nalgebra::{DVector, Isometry3, Vector3};
use vislam::manifold::so3;

use super::Wrong;
use crate::scale_null_space as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    rescaled: right::rescaled,
    scale_direction: right::scale_direction,
    annihilation: right::annihilation,
    with_distance_held: right::with_distance_held,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let rescaled =
        |misconception, rescaled| Wrong::new(misconception, Functions { rescaled, ..REFERENCE });
    let direction = |misconception, scale_direction| {
        Wrong::new(misconception, Functions { scale_direction, ..REFERENCE })
    };
    let measure = |misconception, annihilation| {
        Wrong::new(misconception, Functions { annihilation, ..REFERENCE })
    };
    let held = |misconception, with_distance_held| {
        Wrong::new(misconception, Functions { with_distance_held, ..REFERENCE })
    };
    vec![
        Wrong::new(
            &ABOUT_THE_ORIGIN,
            Functions {
                rescaled: |scene, factor| Scene {
                    cameras: with_translations(&scene, |pose| factor * pose.translation.vector),
                    points: scene.points.iter().map(|point| factor * point).collect(),
                },
                scale_direction: |scene| from_place(&scene, Vector3::zeros(), Vector3::zeros()),
                ..REFERENCE
            },
        ),
        direction(&PIN_ERASED, |scene| {
            let mut direction = from_place(&scene, Vector3::zeros(), Vector3::zeros());
            direction.rows_mut(0, 6).fill(0.0);
            direction
        }),
        direction(&TWO_CENTRES, |scene| {
            from_place(&scene, centre(&scene.cameras[0]), Vector3::zeros())
        }),
        Wrong::new(
            &POINTS_OMITTED,
            Functions {
                rescaled: |scene, factor| {
                    let points = scene.points.clone();
                    Scene { points, ..right::rescaled(scene, factor) }
                },
                scale_direction: |scene| {
                    let first_point = 6 * scene.cameras.len();
                    let direction = right::scale_direction(scene);
                    DVector::from_fn(direction.len(), |row, _| {
                        if row < first_point { direction[row] } else { 0.0 }
                    })
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &CAMERAS_OMITTED,
            Functions {
                rescaled: |scene, factor| {
                    let cameras = scene.cameras.clone();
                    Scene { cameras, ..right::rescaled(scene, factor) }
                },
                scale_direction: |scene| {
                    let first_point = 6 * scene.cameras.len();
                    let mut direction = right::scale_direction(scene);
                    direction.rows_mut(0, first_point).fill(0.0);
                    direction
                },
                ..REFERENCE
            },
        ),
        rescaled(&TRANSLATION_FOR_CENTRE, |scene, factor| {
            let first = scene.cameras[0].translation.vector;
            let cameras = with_translations(&scene, |pose| {
                first + factor * (pose.translation.vector - first)
            });
            Scene { cameras, ..right::rescaled(scene, factor) }
        }),
        rescaled(&CENTRE_AS_TRANSLATION, |scene, factor| {
            let pinned = centre(&scene.cameras[0]);
            let cameras =
                with_translations(&scene, |pose| pinned + factor * (centre(pose) - pinned));
            Scene { cameras, ..right::rescaled(scene, factor) }
        }),
        rescaled(&ROTATIONS_SCALED, |scene, factor| {
            let mut rescaled = right::rescaled(scene, factor);
            for pose in &mut rescaled.cameras {
                let turn = factor * so3::log_quaternion(&pose.rotation);
                pose.rotation = so3::exp_quaternion(&turn);
            }
            rescaled
        }),
        direction(&OTHER_SIGN, |scene| {
            let first_point = 6 * scene.cameras.len();
            let mut direction = right::scale_direction(scene);
            direction.rows_mut(0, first_point).neg_mut();
            direction
        }),
        direction(&CAMERA_AXES, |scene| {
            let mut direction = right::scale_direction(scene.clone());
            for (index, pose) in scene.cameras.iter().enumerate() {
                let turned = pose.rotation * direction.fixed_rows::<3>(6 * index);
                direction.fixed_rows_mut::<3>(6 * index).copy_from(&turned);
            }
            direction
        }),
        direction(&POINTS_FIRST, |scene| {
            let first_point = 6 * scene.cameras.len();
            let direction = right::scale_direction(scene);
            let (cameras, points) = direction.as_slice().split_at(first_point);
            DVector::from_vec([points, cameras].concat())
        }),
        direction(&ROTATION_FIRST, |scene| {
            let mut direction = right::scale_direction(scene.clone());
            for index in 0..scene.cameras.len() {
                for axis in 0..3 {
                    direction.swap_rows(6 * index + axis, 6 * index + axis + 3);
                }
            }
            direction
        }),
        direction(&UNIT_LENGTH, |scene| right::scale_direction(scene).normalize()),
        measure(&NOT_RELATIVE, |hessian, direction| (hessian * direction).norm()),
        measure(&QUADRATIC_FORM, |hessian, direction| {
            direction.dot(&(&hessian * &direction)) / (hessian.norm() * direction.norm_squared())
        }),
        held(&ORTHOGONAL_SHARE, |scene, step| {
            let direction = right::scale_direction(scene).normalize();
            &step - direction.dot(&step) * direction
        }),
        held(&ONE_CAMERA_ONLY, |scene, step| {
            let first_point = 6 * scene.cameras.len();
            let held = right::with_distance_held(scene.clone(), step.clone());
            let direction = right::scale_direction(scene);
            let share = (step[first_point] - held[first_point]) / direction[first_point];
            let mut step = step;
            for row in 6..9 {
                step[row] -= share * direction[row];
            }
            step
        }),
        held(&TURN_FORGOTTEN, |scene, step| {
            let baseline = centre(&scene.cameras[1]) - centre(&scene.cameras[0]);
            let share = -baseline.dot(&step.fixed_rows::<3>(6)) / baseline.norm_squared();
            step - share * right::scale_direction(scene)
        }),
        held(&SHARE_ADDED, |scene, step| {
            let held = right::with_distance_held(scene, step.clone());
            2.0 * step - held
        }),
    ]
}

/// The direction in which cameras run away from one place and points from another.
fn from_place(scene: &Scene, cameras: Vector3<f64>, points: Vector3<f64>) -> DVector<f64> {
    let twists = scene.cameras.iter().flat_map(|pose| {
        let rho = cameras - centre(pose);
        [rho.x, rho.y, rho.z, 0.0, 0.0, 0.0]
    });
    let velocities = scene.points.iter().flat_map(|point| <[f64; 3]>::from(point - points));
    DVector::from_vec(twists.chain(velocities).collect())
}

fn with_translations(
    scene: &Scene,
    translation: impl Fn(&Isometry3<f64>) -> Vector3<f64>,
) -> Vec<Isometry3<f64>> {
    let pose =
        |pose: &Isometry3<f64>| Isometry3::from_parts(translation(pose).into(), pose.rotation);
    scene.cameras.iter().map(pose).collect()
}

fn centre(camera_from_world: &Isometry3<f64>) -> Vector3<f64> {
    camera_from_world.inverse().translation.vector
}
