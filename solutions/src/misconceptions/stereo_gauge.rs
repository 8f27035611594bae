//! Wrong answers to [`stereo_gauge`](crate::stereo_gauge).

use exercise_spec::stereo_gauge::*;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix2x3, Matrix2x6, Matrix6, Vector3};
use vislam::manifold::se3;

use super::Wrong;
use crate::stereo_gauge as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    right_from_world: right::right_from_world,
    right_blocks: right::right_blocks,
    reduced_system: right::reduced_system,
    stiffnesses: right::stiffnesses,
    rigid_motions: right::rigid_motions,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let system = |misconception, reduced_system| {
        Wrong::new(misconception, Functions { reduced_system, ..REFERENCE })
    };
    let values = |misconception, stiffnesses| {
        Wrong::new(misconception, Functions { stiffnesses, ..REFERENCE })
    };
    let motions = |misconception, rigid_motions| {
        Wrong::new(misconception, Functions { rigid_motions, ..REFERENCE })
    };
    vec![
        Wrong::new(
            &BASELINE_SIGN,
            Functions {
                right_from_world: |left, baseline| right::right_from_world(left, -baseline),
                right_blocks: |camera, left, baseline, point| {
                    right::right_blocks(camera, left, -baseline, point)
                },
                reduced_system: |scene, baseline, hold_first| {
                    right::reduced_system(scene, baseline.map(|baseline| -baseline), hold_first)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &BASELINE_IN_WORLD,
            Functions {
                right_from_world: |left, baseline| left * shift(baseline),
                right_blocks: in_world,
                reduced_system: |scene, baseline, hold_first| {
                    reduced(&scene, baseline, hold_first, in_world)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &ADJOINT_FORGOTTEN,
            Functions {
                right_blocks: own_twist,
                reduced_system: |scene, baseline, hold_first| {
                    reduced(&scene, baseline, hold_first, own_twist)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &ADJOINT_INVERTED,
            Functions {
                right_blocks: carried_back,
                reduced_system: |scene, baseline, hold_first| {
                    reduced(&scene, baseline, hold_first, carried_back)
                },
                rigid_motions: |poses| {
                    right::rigid_motions(poses.iter().map(Isometry3::inverse).collect())
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &TWIST_ON_THE_RIGHT,
            Functions {
                right_blocks: right_twist,
                reduced_system: |scene, baseline, hold_first| {
                    reduced(&scene, baseline, hold_first, right_twist)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &LEFT_PIXEL,
            Functions {
                right_blocks: |camera, left, _, point| {
                    right::right_blocks(camera, left, 0.0, point)
                },
                ..REFERENCE
            },
        ),
        system(&FREE_RIGHT_CAMERA, |scene, baseline, hold_first| {
            let Some(baseline) = baseline else {
                return right::reduced_system(scene, None, hold_first);
            };
            let both = |left: &Isometry3<f64>| [*left, right::right_from_world(*left, baseline)];
            let left_from_world = scene.left_from_world.iter().flat_map(both).collect();
            right::reduced_system(Scene { left_from_world, ..scene }, None, hold_first)
        }),
        system(&POINTS_NAILED, |scene, baseline, hold_first| {
            let held = usize::from(hold_first);
            let [by_rigs, _] = jacobian(&scene, baseline, held, right::right_blocks);
            by_rigs.tr_mul(&by_rigs)
        }),
        system(&POINTS_LEFT_IN, |scene, baseline, hold_first| {
            let held = usize::from(hold_first);
            let [by_rigs, by_points] = jacobian(&scene, baseline, held, right::right_blocks);
            let columns: Vec<_> = by_rigs.column_iter().chain(by_points.column_iter()).collect();
            let all = DMatrix::from_columns(&columns);
            all.tr_mul(&all)
        }),
        system(&COUPLING_ADDED, |scene, baseline, hold_first| {
            let held = usize::from(hold_first);
            let [by_rigs, _] = jacobian(&scene, baseline, held, right::right_blocks);
            2.0 * by_rigs.tr_mul(&by_rigs) - right::reduced_system(scene, baseline, hold_first)
        }),
        system(&HELD_IS_BLIND, |mut scene, baseline, hold_first| {
            scene.left_from_world.drain(..usize::from(hold_first));
            right::reduced_system(scene, baseline, false)
        }),
        system(&STILL_FREE, |scene, baseline, _| right::reduced_system(scene, baseline, false)),
        system(&UNWHITENED, |scene, baseline, hold_first| {
            right::reduced_system(Scene { sigma: 1.0, ..scene }, baseline, hold_first)
        }),
        system(&SECOND_LENS_UNUSED, |scene, _, hold_first| {
            right::reduced_system(scene, None, hold_first)
        }),
        system(&ROW_LEFT_OUT, |scene, baseline, hold_first| {
            reduced(&scene, baseline, hold_first, |camera, left, baseline, point| {
                let (mut by_twist, mut by_point) =
                    right::right_blocks(camera, left, baseline, point);
                if baseline > 0.0 {
                    by_twist.row_mut(1).fill(0.0);
                    by_point.row_mut(1).fill(0.0);
                }
                (by_twist, by_point)
            })
        }),
        values(&UNITS_MIXED, |reduced| sorted(reduced.symmetric_eigenvalues())),
        values(&UNITS_SQUARED, |reduced| {
            let unit = reduced.diagonal().map(f64::recip);
            sorted(reduced.component_mul(&(&unit * unit.transpose())).symmetric_eigenvalues())
        }),
        values(&DESCENDING, |reduced| {
            let mut values = right::stiffnesses(reduced);
            values.reverse();
            values
        }),
        motions(&OPPOSITE_MOTION, |poses| -right::rigid_motions(poses)),
        motions(&SAME_FOR_ALL, |poses| {
            DMatrix::from_fn(6 * poses.len(), 6, |row, column| {
                -Matrix6::<f64>::identity()[(row % 6, column)]
            })
        }),
    ]
}

/// Derivatives of the right pixel by a twist and by the point.
type Blocks = fn(Camera, Isometry3<f64>, f64, Vector3<f64>) -> (Matrix2x6<f64>, Matrix2x3<f64>);

fn in_world(
    camera: Camera,
    left: Isometry3<f64>,
    baseline: f64,
    point: Vector3<f64>,
) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    right::right_blocks(camera, left * shift(baseline), 0.0, point)
}

fn own_twist(
    camera: Camera,
    left: Isometry3<f64>,
    baseline: f64,
    point: Vector3<f64>,
) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    right::right_blocks(camera, right::right_from_world(left, baseline), 0.0, point)
}

fn carried_back(
    camera: Camera,
    left: Isometry3<f64>,
    baseline: f64,
    point: Vector3<f64>,
) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    let (by_twist, by_point) = own_twist(camera, left, baseline, point);
    (by_twist * se3::adjoint(&shift(baseline).inverse()), by_point)
}

fn right_twist(
    camera: Camera,
    left: Isometry3<f64>,
    baseline: f64,
    point: Vector3<f64>,
) -> (Matrix2x6<f64>, Matrix2x3<f64>) {
    let (by_twist, by_point) = right::right_blocks(camera, left, baseline, point);
    (by_twist * se3::adjoint(&left), by_point)
}

fn shift(baseline: f64) -> Isometry3<f64> {
    Isometry3::translation(-baseline, 0.0, 0.0)
}

/// The whitened Jacobian of all pixels by rigs and by points, from any blocks.
fn jacobian(
    scene: &Scene,
    baseline: Option<f64>,
    held: usize,
    blocks: Blocks,
) -> [DMatrix<f64>; 2] {
    let offsets: Vec<f64> = [Some(0.0), baseline].into_iter().flatten().collect();
    let (rigs, points) = (scene.left_from_world.len(), scene.points.len());
    let height = 2 * offsets.len() * rigs * points;
    let mut by_rigs = DMatrix::zeros(height, 6 * (rigs - held));
    let mut by_points = DMatrix::zeros(height, 3 * points);
    let mut row = 0;
    for (rig, left) in scene.left_from_world.iter().enumerate() {
        for (which, point) in scene.points.iter().enumerate() {
            for offset in &offsets {
                let (by_twist, by_point) = blocks(scene.camera, *left, *offset, *point);
                if rig >= held {
                    by_rigs.fixed_view_mut::<2, 6>(row, 6 * (rig - held)).copy_from(&by_twist);
                }
                by_points.fixed_view_mut::<2, 3>(row, 3 * which).copy_from(&by_point);
                row += 2;
            }
        }
    }
    [by_rigs / scene.sigma, by_points / scene.sigma]
}

/// The reduced system of any blocks, all points at once.
fn reduced(scene: &Scene, baseline: Option<f64>, hold_first: bool, blocks: Blocks) -> DMatrix<f64> {
    let [by_rigs, by_points] = jacobian(scene, baseline, usize::from(hold_first), blocks);
    let own = by_points.tr_mul(&by_points);
    let coupling = by_rigs.tr_mul(&by_points);
    let inverse = own.try_inverse().unwrap_or_else(|| DMatrix::zeros(0, 0));
    by_rigs.tr_mul(&by_rigs) - &coupling * inverse * coupling.transpose()
}

fn sorted(values: DVector<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}
