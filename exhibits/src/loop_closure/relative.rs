//! The error of a relative pose, and its covariance as a filter believes it.

use nalgebra::{DMatrix, Isometry3, Matrix6, SMatrix, SVector};
use vislam::factors::GraphPose;
use vislam::filtering::Belief;
use vislam::inertial::BodyPose;
use vislam::least_squares::Manifold;
use vislam::loop_closure::RelativeMeasurement;
use vislam::manifold::se3;

use super::STATES;
use super::draws::{covariance, pose};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Slopes = |poses, measured| {
        let (_, by_first, by_second) = poses[0].linearized_error(&poses[1], measured)?;
        Some([by_first, by_second])
    };
    let mutants: [(_, Slopes); 4] = [
        ("the adjoint of the other direction", |poses, measured| {
            let (bend, apart) = parts(poses, measured);
            Some([-bend * se3::adjoint(&apart), bend])
        }),
        ("both with the same sign", |poses, measured| {
            let (bend, apart) = parts(poses, measured);
            Some([bend * se3::adjoint(&apart.inverse()), bend])
        }),
        ("without the bend of the logarithm", |poses, measured| {
            let (_, apart) = parts(poses, measured);
            Some([-se3::adjoint(&apart.inverse()), Matrix6::identity()])
        }),
        ("the left Jacobian", |poses, measured| {
            let (_, apart) = parts(poses, measured);
            let bend = se3::left_jacobian_inverse(&se3::local(measured, &apart));
            Some([-bend * se3::adjoint(&apart.inverse()), bend])
        }),
    ];
    chapter.equation("loop-slopes", loop_slopes, formula, &mutants);

    let mutants: [(_, Between); 4] = [
        ("as if both were independent", |poses, joint| {
            let apart = altered(*joint, |joint| {
                joint.fixed_view_mut::<6, 6>(0, 6).fill(0.0);
                joint.fixed_view_mut::<6, 6>(6, 0).fill(0.0);
            });
            believed(poses, &apart)
        }),
        ("the first step not seen from the second", |poses, joint| {
            Some(by_blocks([-twist(&poses[0]), twist(&poses[1])], joint))
        }),
        ("shifts along the axes of the world", |poses, joint| {
            let level = BodyPose { world_from_body: Default::default(), ..poses[0] };
            let by_first = -seen_back(poses) * twist(&level);
            Some(by_blocks([by_first, twist(&level)], joint))
        }),
        ("added", |poses, joint| {
            Some(by_blocks([seen_back(poses) * twist(&poses[0]), twist(&poses[1])], joint))
        }),
    ];
    chapter.equation("loop-covariance", loop_covariance, believed, &mutants);
}

/// The derivatives of the error of a measurement by a step of the first and of the second pose.
type Slopes = fn(&[Isometry3<f64>; 2], &Isometry3<f64>) -> Option<[Matrix6<f64>; 2]>;

/// The inverse right Jacobian at the error, and the second pose from the first.
fn parts(poses: &[Isometry3<f64>; 2], measured: &Isometry3<f64>) -> (Matrix6<f64>, Isometry3<f64>) {
    let apart = poses[0].inv_mul(&poses[1]);
    (se3::right_jacobian_inverse(&se3::local(measured, &apart)), apart)
}

fn loop_slopes(formula: Slopes) -> Comparison {
    let against = "central differences of the logarithm";
    Comparison::relative(against, 1e-6).over(STATES, 81, |random| {
        let poses = [pose(random), pose(random)];
        let off = se3::exp(&super::draws::twist(random, 0.5, 0.4));
        let measured = poses[0].inv_mul(&poses[1]) * off;
        let error = |first: &Isometry3<f64>, second: &Isometry3<f64>| {
            se3::log(&(measured.inverse() * first.inverse() * second))
        };
        let slopes = [
            differences(1e-5, |step| error(&(poses[0] * se3::exp(&step)), &poses[1])),
            differences(1e-5, |step| error(&poses[0], &(poses[1] * se3::exp(&step)))),
        ];
        (formula(&poses, &measured), slopes)
    })
}

type Matrix12 = SMatrix<f64, 12, 12>;

/// The covariance of a relative pose, by that of both poses.
type Between = fn(&[BodyPose; 2], &Matrix12) -> Option<Matrix6<f64>>;

/// The library's, from a belief with this covariance.
fn believed(poses: &[BodyPose; 2], joint: &Matrix12) -> Option<Matrix6<f64>> {
    let block = |row, column| joint.fixed_view::<6, 6>(row, column).into_owned();
    let dynamic = |matrix: Matrix6<f64>| DMatrix::from_column_slice(6, 6, matrix.as_slice());
    let mut belief = Belief::new();
    let first = belief.add(poses[0], &dynamic(block(0, 0))).ok()?;
    let by_first = block(6, 0) * block(0, 0).try_inverse()?;
    let rest = block(6, 6) - by_first * block(0, 6);
    let second = belief.add_function(poses[1], &dynamic(by_first), &dynamic(rest)).ok()?;
    let seen = RelativeMeasurement::believed(&belief, [first, second], [0, 1]).ok()?;
    seen.information.try_inverse()
}

/// The twist of a step (φ, p) of a pose.
fn twist(pose: &BodyPose) -> Matrix6<f64> {
    let mut twist = Matrix6::zeros();
    twist.fixed_view_mut::<3, 3>(0, 3).copy_from(&pose.world_from_body.matrix().transpose());
    twist.fixed_view_mut::<3, 3>(3, 0).fill_diagonal(1.0);
    twist
}

/// A twist of the first pose as one of the second.
fn seen_back(poses: &[BodyPose; 2]) -> Matrix6<f64> {
    let [first, second] = [0, 1].map(|at: usize| poses[at].at_rest().pose());
    se3::adjoint(&second.inv_mul(&first))
}

fn by_blocks([by_first, by_second]: [Matrix6<f64>; 2], joint: &Matrix12) -> Matrix6<f64> {
    let mut by_both = SMatrix::<f64, 6, 12>::zeros();
    by_both.fixed_view_mut::<6, 6>(0, 0).copy_from(&by_first);
    by_both.fixed_view_mut::<6, 6>(0, 6).copy_from(&by_second);
    by_both * joint * by_both.transpose()
}

fn loop_covariance(formula: Between) -> Comparison {
    let against = "central differences of the relative pose by both";
    Comparison::relative(against, 1e-6).over(STATES, 82, |random| {
        let poses = [(); 2].map(|()| BodyPose {
            world_from_body: random.rotation(3.0),
            position: random.direction(4.0),
        });
        let joint: Matrix12 = covariance(random);
        let apart = |poses: [BodyPose; 2]| {
            let [first, second] = poses.map(|pose| pose.at_rest().pose());
            first.inv_mul(&second)
        };
        let measured = apart(poses);
        let by_both: SMatrix<f64, 6, 12> = differences(1e-5, |step: SVector<f64, 12>| {
            let moved = [0, 1].map(|at: usize| poses[at].retract(&step.as_slice()[6 * at..][..6]));
            se3::log(&(measured.inverse() * apart(moved)))
        });
        (formula(&poses, &joint), by_both * joint * by_both.transpose())
    })
}
