//! Four degrees of freedom: the error, and its part of a covariance.

use nalgebra::{Isometry3, Matrix3, Matrix4, Rotation3, SMatrix, Vector3, Vector4, Vector6};
use vislam::factors::GraphPose;
use vislam::loop_closure::{PoseGraph, RelativeMeasurement, UprightPose};
use vislam::manifold::{se3, so3};

use super::STATES;
use super::draws::{covariance, pose};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Error = |first, second, measured| {
        UprightPose::new(*first).error(&UprightPose::new(*second), measured)
    };
    let mutants: [(_, Error); 4] = [
        ("the shift in the frame of the second body", |first, second, measured| {
            let apart = second.translation.vector - first.translation.vector;
            let shift = second.rotation.inverse() * apart - measured.translation.vector;
            Some(shift.push(yaw(&left(first, second, measured))))
        }),
        ("differences of Euler angles", |first, second, measured| {
            let of = |pose: &Isometry3<f64>| pose.rotation.euler_angles().2;
            let yaw = of(second) - of(first) - of(measured);
            Some(shift(first, second, measured).push(so3::log(&about_z(yaw)).z))
        }),
        ("the turn on the side of the body", |first, second, measured| {
            let turn = (first.rotation * measured.rotation).inverse() * second.rotation;
            let turn = turn.to_rotation_matrix().into_inner();
            Some(shift(first, second, measured).push(yaw(&turn)))
        }),
        ("the turn the other way", |first, second, measured| {
            let turn = left(first, second, measured).transpose();
            Some(shift(first, second, measured).push(yaw(&turn)))
        }),
    ];
    chapter.equation("upright-error", upright_error, formula, &mutants);

    let mutants: [(_, Part); 4] = [
        ("as if tilt were held", |first, measured, six| {
            let by_four = change(measured, &up(&(first * measured)));
            (by_four.transpose() * six.try_inverse()? * by_four).try_inverse()
        }),
        ("the vertical of the first body", |first, measured, six| {
            let by_four = change(measured, &up(first));
            Some(by_four.transpose() * six * by_four)
        }),
        ("the third axis of the body", |_, measured, six| {
            let by_four = change(measured, &Vector3::z());
            Some(by_four.transpose() * six * by_four)
        }),
        ("axes of the second body", |first, measured, six| {
            let by_four = change(&Isometry3::identity(), &up(&(first * measured)));
            Some(by_four.transpose() * six * by_four)
        }),
    ];
    chapter.equation("upright-information", upright_information, upright_part, &mutants);
}

/// The error of a measurement of one upright pose from another.
type Error = fn(&Isometry3<f64>, &Isometry3<f64>, &Isometry3<f64>) -> Option<Vector4<f64>>;

fn about_z(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

fn shift(
    first: &Isometry3<f64>,
    second: &Isometry3<f64>,
    measured: &Isometry3<f64>,
) -> Vector3<f64> {
    let apart = second.translation.vector - first.translation.vector;
    first.rotation.inverse() * apart - measured.translation.vector
}

/// What is left between the second rotation and the one that was measured, in the world.
fn left(
    first: &Isometry3<f64>,
    second: &Isometry3<f64>,
    measured: &Isometry3<f64>,
) -> Matrix3<f64> {
    let turn = second.rotation * (first.rotation * measured.rotation).inverse();
    turn.to_rotation_matrix().into_inner()
}

fn yaw(turn: &Matrix3<f64>) -> f64 {
    (turn.m21 - turn.m12).atan2(turn.m11 + turn.m22)
}

fn upright_error(formula: Error) -> Comparison {
    let against = "a pose that was put where it has a known error, and tilted besides";
    Comparison::absolute(against, 1e-9, "m, rad").over(STATES, 84, |random| {
        let (first, measured) = (pose(random), pose(random));
        let known = Vector4::from_fn(|_, _| random.normal(0.5));
        let tilt = so3::exp(&Vector3::new(random.normal(0.2), random.normal(0.2), 0.0));
        let place = measured.translation.vector + known.xyz();
        let position = first.translation.vector + first.rotation * place;
        let turned = (first.rotation * measured.rotation).to_rotation_matrix();
        let rotation = about_z(known.w) * tilt * turned;
        let second = Isometry3::from_parts(position.into(), rotation.into());
        (formula(&first, &second, &measured), known)
    })
}

/// The covariance of the four, from a pose, the measurement from it, and the covariance of the six.
type Part = fn(&Isometry3<f64>, &Isometry3<f64>, &SMatrix<f64, 6, 6>) -> Option<Matrix4<f64>>;

/// The library's.
fn upright_part(
    first: &Isometry3<f64>,
    measured: &Isometry3<f64>,
    six: &SMatrix<f64, 6, 6>,
) -> Option<Matrix4<f64>> {
    let information = six.try_inverse()?;
    let information = 0.5 * (information + information.transpose());
    let seen = RelativeMeasurement { first: 0, second: 1, measured: *measured, information };
    let graph = PoseGraph { poses: vec![*first, first * measured], measurements: vec![seen] };
    graph.upright().measurements[0].information.try_inverse()
}

fn up(pose: &Isometry3<f64>) -> Vector3<f64> {
    pose.rotation.inverse() * Vector3::z()
}

/// The change of the six by the four.
fn change(measured: &Isometry3<f64>, up: &Vector3<f64>) -> SMatrix<f64, 6, 4> {
    let mut change = SMatrix::<f64, 6, 4>::zeros();
    let turned = measured.rotation.to_rotation_matrix().transpose();
    change.fixed_view_mut::<3, 3>(0, 0).copy_from(turned.matrix());
    change.fixed_view_mut::<3, 1>(3, 3).copy_from(up);
    change
}

fn upright_information(formula: Part) -> Comparison {
    let against = "central differences of the error of four by the six";
    Comparison::relative(against, 1e-6).over(STATES, 85, |random| {
        let (first, measured) = (pose(random), pose(random));
        let six = covariance::<6>(random);
        let by_six: SMatrix<f64, 4, 6> = differences(1e-5, |step: Vector6<f64>| {
            let second = first * measured * se3::exp(&step);
            let four = UprightPose::new(first).error(&UprightPose::new(second), &measured);
            four.unwrap_or(Vector4::repeat(f64::NAN))
        });
        (formula(&first, &measured, &six), by_six * six * by_six.transpose())
    })
}
