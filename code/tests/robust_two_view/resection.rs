//! A camera's pose from points, and the similarity between two worlds.

use nalgebra::{Isometry3, SVector, UnitQuaternion, Vector2, Vector3};
use vislam::manifold::se3;
use vislam::observability::Similarity;
use vislam::robust_two_view::{ConsensusError, ConsensusOptions, consensus};
use vislam::structure_from_motion::{
    OrientationError, PointPairs, ResectionError, ScaleFreedom, Sightings, ThreePointError,
    absolute_orientation, linear_pose, poses_of_three, resect,
};

use super::scenes::{CAMERA, any_pixel, motion, normal, random, seen_point, vector};

/// Points in the picture of a camera at a random pose, and their pixels without noise.
fn seen(
    random: &mut rand_chacha::ChaCha8Rng,
    count: usize,
) -> (Isometry3<f64>, Vec<Vector3<f64>>, Vec<Vector2<f64>>) {
    let mut pose = motion(random);
    pose.translation.vector += 4.0 * vector(random);
    let world_from_camera = pose.inverse();
    let in_camera: Vec<_> =
        (0..count).map(|_| seen_point(random, &Isometry3::identity())).collect();
    let points = in_camera.iter().map(|point| se3::transform(&world_from_camera, point)).collect();
    let pixels = in_camera.iter().map(|point| CAMERA.project_cam(point).unwrap()).collect();
    (pose, points, pixels)
}

fn off(one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
    se3::local(one, other).norm()
}

#[test]
fn the_true_pose_is_among_those_of_three_points() {
    let mut random = random(51);
    let (mut count, mut lost) = (0, 0);
    for _ in 0..10_000 {
        let (pose, points, _) = seen(&mut random, 3);
        let points = [points[0], points[1], points[2]];
        let directions = points.map(|point| 0.3 * se3::transform(&pose, &point));
        let poses = poses_of_three(&points, &directions).unwrap();
        count += poses.len();
        for found in poses.iter() {
            for (point, direction) in points.iter().zip(&directions) {
                let seen = se3::transform(found, point);
                assert!(seen.normalize().cross(&direction.normalize()).norm() < 1e-5);
            }
        }
        lost += usize::from(!poses.iter().any(|found| off(found, &pose) < 1e-6));
    }
    assert!(count > 10_000 && count < 40_000);
    assert!(lost <= 5, "{lost} lost");
}

#[test]
fn three_points_that_leave_the_pose_open_are_refused_by_name() {
    let (a, b) = (Vector3::new(0.0, 0.0, 4.0), Vector3::new(1.0, 0.5, 5.0));
    let line = [a, b, 0.5 * (a + b)];
    assert_eq!(poses_of_three(&line, &line), Err(ThreePointError::Collinear));
    let points = [a, b, Vector3::new(-1.0, 0.5, 4.0)];
    let mut directions = points;
    directions[2] = 2.0 * directions[1];
    let refused = ThreePointError::SameDirection { first: 1, second: 2 };
    assert_eq!(poses_of_three(&points, &directions), Err(refused));
    directions[2].x = f64::NAN;
    let refused = ThreePointError::NotFinite { point: 2 };
    assert_eq!(poses_of_three(&points, &directions), Err(refused));
}

#[test]
fn the_linear_pose_is_exact_without_noise_and_refuses_a_plane_and_a_point() {
    let mut random = random(52);
    for _ in 0..100 {
        let (pose, points, pixels) = seen(&mut random, 8);
        assert!(off(&linear_pose(&CAMERA, &points, &pixels).unwrap(), &pose) < 1e-6);
        assert!(off(&linear_pose(&CAMERA, &points[..6], &pixels[..6]).unwrap(), &pose) < 1e-4);
    }
    let (_, mut points, _) = seen(&mut random, 8);
    points.iter_mut().for_each(|point| *point = Vector3::new(point.x, point.y, 5.0));
    let pixels: Vec<_> = points.iter().map(|p| CAMERA.project_cam(p).unwrap()).collect();
    assert_eq!(linear_pose(&CAMERA, &points, &pixels), Err(ResectionError::Degenerate));
    points[0].z = 3.0;
    for _ in 0..100 {
        let pixel =
            |p| CAMERA.project_cam(p).unwrap() + Vector2::from_fn(|_, _| normal(&mut random));
        let noisy: Vec<_> = points.iter().map(pixel).collect();
        assert_eq!(linear_pose(&CAMERA, &points, &noisy), Err(ResectionError::Degenerate));
    }
    let refused = linear_pose(&CAMERA, &points[..5], &pixels[..5]);
    assert_eq!(refused, Err(ResectionError::TooFew { count: 5, needed: 6 }));
    let refused = linear_pose(&CAMERA, &points, &pixels[..5]);
    assert_eq!(refused, Err(ResectionError::Lengths { points: 8, pixels: 5 }));
    points[3].x = f64::NAN;
    let refused = linear_pose(&CAMERA, &points, &pixels);
    assert_eq!(refused, Err(ResectionError::NotFinite { point: 3 }));
}

#[test]
fn the_refined_pose_is_as_wrong_as_its_covariance_says() {
    let mut random = random(53);
    let mut sum = 0.0;
    let scenes = 200;
    for _ in 0..scenes {
        let (pose, points, mut pixels) = seen(&mut random, 40);
        pixels.iter_mut().for_each(|p| *p += Vector2::from_fn(|_, _| 0.5 * normal(&mut random)));
        let start = linear_pose(&CAMERA, &points, &pixels).unwrap();
        let found = resect(&CAMERA, &points, &pixels, 0.5, &start).unwrap();
        let error = se3::local(&found.camera_from_world, &pose);
        let information = found.covariance.try_inverse().unwrap();
        sum += (error.transpose() * information * error)[0];
    }
    // Six degrees of freedom; the mean of 200 scatters by √(12/200).
    let mean = sum / scenes as f64;
    assert!((mean - 6.0).abs() < 1.0, "{mean}");
}

#[test]
fn half_of_the_sightings_may_be_wrong() {
    let mut random = random(54);
    let (pose, points, mut pixels) = seen(&mut random, 100);
    pixels.iter_mut().for_each(|p| *p += Vector2::from_fn(|_, _| normal(&mut random)));
    pixels.iter_mut().skip(50).for_each(|pixel| *pixel = any_pixel(&mut random));
    let data = Sightings { camera: &CAMERA, points: &points, pixels: &pixels, sigma: 1.0 };
    let found = consensus(&data, &ConsensusOptions::default()).unwrap();
    let right = found.inliers.iter().filter(|datum| **datum < 50).count();
    assert!(right > 45 && found.inliers.len() - right < 3);
    assert!(off(&found.estimate, &pose) < 0.05);
    assert!(found.covariance.is_some());

    let wrong: Vec<_> = (0..100).map(|_| any_pixel(&mut random)).collect();
    let data = Sightings { pixels: &wrong, ..data };
    let options = ConsensusOptions { most_draws: 1000, ..Default::default() };
    assert!(matches!(consensus(&data, &options), Err(ConsensusError::Chance { .. })));
}

fn a_similarity() -> Similarity {
    let rotation = UnitQuaternion::from_euler_angles(0.3, -1.2, 2.0).to_rotation_matrix();
    Similarity { scale: 2.5, rotation, translation: Vector3::new(1.0, -2.0, 30.0) }
}

fn is_near(one: &Similarity, other: &Similarity, tolerance: f64) -> bool {
    (one.scale - other.scale).abs() < tolerance
        && (one.rotation.matrix() - other.rotation.matrix()).amax() < tolerance
        && (one.translation - other.translation).amax() < 10.0 * tolerance
}

#[test]
fn two_worlds_are_laid_upon_each_other() {
    let mut random = random(55);
    let truth = a_similarity();
    for count in [3, 4, 50] {
        let pairs: Vec<_> = (0..count)
            .map(|_| {
                let point = 3.0 * vector(&mut random);
                (point, truth.point(&point))
            })
            .collect();
        let found = absolute_orientation(&pairs, ScaleFreedom::Free).unwrap();
        assert!(is_near(&found, &truth, 1e-10));
        let rigid = absolute_orientation(&pairs, ScaleFreedom::One).unwrap();
        assert_eq!(rigid.scale, 1.0);
        assert!((rigid.rotation.matrix() - truth.rotation.matrix()).amax() < 1e-10);
    }
}

#[test]
fn worlds_that_leave_the_similarity_open_are_refused_by_name() {
    let truth = a_similarity();
    let of = |points: &[Vector3<f64>]| {
        let pairs: Vec<_> = points.iter().map(|point| (*point, truth.point(point))).collect();
        absolute_orientation(&pairs, ScaleFreedom::Free)
    };
    let step = Vector3::new(0.1, -0.3, 0.2);
    let line: Vec<_> = (0..10).map(|k| k as f64 * step).collect();
    assert_eq!(of(&line), Err(OrientationError::Rotation));
    assert_eq!(of(&[step; 5]), Err(OrientationError::OnePlace));
    assert_eq!(of(&line[..2]), Err(OrientationError::TooFew { count: 2 }));
    assert_eq!(
        of(&[step, step, Vector3::repeat(f64::NAN)]),
        Err(OrientationError::NotFinite { pair: 2 })
    );
    // A regular octahedron and its mirror image: several turns do as well.
    let corners: Vec<_> = (0..6)
        .map(|k| if k < 3 { Vector3::ith(k, 1.0) } else { Vector3::ith(k - 3, -1.0) })
        .collect();
    let mirrored: Vec<_> = corners.iter().map(|corner| (*corner, -corner)).collect();
    let refused = absolute_orientation(&mirrored, ScaleFreedom::Free);
    assert_eq!(refused, Err(OrientationError::Rotation));
}

#[test]
fn points_of_two_worlds_may_be_wrong_too() {
    let mut random = random(56);
    let truth = a_similarity();
    let pairs: Vec<_> = (0..60)
        .map(|k| {
            let point = 3.0 * vector(&mut random);
            let noise = Vector3::from_fn(|_, _| 0.05 * normal(&mut random));
            let there =
                if k < 30 { truth.point(&point) + noise } else { 20.0 * vector(&mut random) };
            (point, there)
        })
        .collect();
    let data = PointPairs { pairs: &pairs, sigma: 0.05 };
    let found = consensus(&data, &ConsensusOptions::default()).unwrap();
    assert!(found.inliers.len() >= 28 && found.inliers.iter().all(|datum| *datum < 30));
    let covariance = found.covariance.unwrap();
    let error = truth.translation - found.estimate.translation;
    let turn = (found.estimate.rotation.inverse() * truth.rotation).scaled_axis();
    let scale = (truth.scale / found.estimate.scale).ln();
    let off = SVector::<f64, 7>::from([error.x, error.y, error.z, turn.x, turn.y, turn.z, scale]);
    let square = (off.transpose() * covariance.try_inverse().unwrap() * off)[0];
    // 99.9 % of seven degrees of freedom.
    assert!(square < 24.3, "{square}");
}
