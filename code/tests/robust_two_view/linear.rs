//! Eight points, homographies and rotations.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};
use vislam::robust_two_view::{
    EightPointError, HomographyError, RayPair, RelativeMotion, eight_points, homography_of_four,
    homography_of_many, plane_motions, rotation_of_rays,
};

use super::scenes::{distance, motion, number, random, rays, seen_point, small_motion};

/// Points in front of both cameras.
fn many(count: usize, pose: &Isometry3<f64>, seed: u64) -> Vec<RayPair> {
    let mut random = random(seed);
    let forward = |random: &mut _| loop {
        let pair = rays(pose, &seen_point(random, pose));
        if pair.1.z > 0.05 {
            break pair;
        }
    };
    (0..count).map(|_| forward(&mut random)).collect()
}

/// The plane n·P = 1.
const NORMAL: Vector3<f64> = Vector3::new(0.05, -0.04, 0.2);

fn on_plane(pose: &Isometry3<f64>, seed: u64, count: usize) -> Vec<RayPair> {
    let mut random = random(seed);
    let point = |_| {
        let slopes = Vector3::new(number(&mut random), number(&mut random), 1.0);
        rays(pose, &(slopes / NORMAL.dot(&slopes)))
    };
    (0..count).map(point).collect()
}

#[test]
fn eight_points_give_the_essential_matrix() {
    let mut random = random(11);
    for seed in 0..100 {
        let pose = motion(&mut random);
        for count in [8, 9, 30] {
            let found = eight_points(&many(count, &pose, seed)).unwrap();
            let truth = RelativeMotion::of(&pose).unwrap().essential();
            assert!(distance(&found, &truth) < 1e-6);
        }
    }
}

#[test]
fn eight_points_need_eight_that_are_not_in_a_plane() {
    let pose = small_motion(&mut random(12));
    let pairs = many(9, &pose, 1);
    assert_eq!(eight_points(&pairs[..7]), Err(EightPointError::TooFew { count: 7 }));
    assert_eq!(eight_points(&on_plane(&pose, 2, 20)), Err(EightPointError::Degenerate));
    assert_eq!(eight_points(&[pairs[0]; 8]), Err(EightPointError::Degenerate));
    let mut broken = pairs;
    broken[3].0.x = f64::NAN;
    assert_eq!(eight_points(&broken), Err(EightPointError::Ray { pair: 3 }));
}

#[test]
fn four_points_give_the_homography_of_their_plane_and_so_do_many() {
    let mut random = random(13);
    for seed in 0..100 {
        let pose = small_motion(&mut random);
        let truth = pose.rotation.to_rotation_matrix().into_inner()
            + pose.translation.vector * NORMAL.transpose();
        let pairs = on_plane(&pose, seed, 12);
        let four = [0, 1, 2, 3].map(|k| pairs[k]);
        assert!(distance(&homography_of_four(&four).unwrap(), &truth) < 1e-8);
        assert!(distance(&homography_of_many(&pairs).unwrap(), &truth) < 1e-10);
        assert!(distance(&homography_of_many(&four).unwrap(), &truth) < 1e-7);
    }
}

#[test]
fn points_of_a_line_have_no_homography() {
    let pose = small_motion(&mut random(14));
    let mut four = [0, 1, 2, 3].map(|k| on_plane(&pose, 5, 4)[k]);
    four[2] = rays(&pose, &(0.5 * (four[0].0 + four[1].0)));
    assert_eq!(homography_of_four(&four), Err(HomographyError::Collinear));
    four[1].0.x = f64::NAN;
    assert_eq!(homography_of_four(&four), Err(HomographyError::Ray { pair: 1 }));
    let line: Vec<_> =
        (0..10).map(|k| rays(&pose, &Vector3::new(0.3 * k as f64 - 1.0, 0.2, 4.0))).collect();
    assert_eq!(homography_of_many(&line), Err(HomographyError::Collinear));
    assert_eq!(homography_of_many(&line[..3]), Err(HomographyError::TooFew { count: 3 }));
}

#[test]
fn the_motion_of_a_plane_is_one_of_two() {
    let mut random = random(15);
    for seed in 0..200 {
        let pose = small_motion(&mut random);
        let pairs = on_plane(&pose, seed, 12);
        let homography = homography_of_many(&pairs).unwrap();
        let directions: Vec<_> = pairs.iter().map(|pair| pair.0).collect();
        let motions = plane_motions(&homography, &directions).unwrap();
        let truth = RelativeMotion::of(&pose).unwrap();
        let is_true = |found: &vislam::robust_two_view::PlaneMotion| {
            (found.motion.rotation.matrix() - truth.rotation.matrix()).amax() < 1e-6
                && (found.motion.direction.into_inner() - truth.direction.into_inner()).amax()
                    < 1e-6
                && (found.normal.into_inner() - NORMAL.normalize()).amax() < 1e-6
                && (found.baseline - 0.5 * NORMAL.norm()).abs() < 1e-6
        };
        assert_eq!(motions.iter().filter(|found| is_true(found)).count(), 1);
        // One of many wrong matches that agree by accident may lie beyond the horizon.
        let mut many = directions.repeat(2);
        many.push(Vector3::z() - 10.0 * NORMAL);
        let motions = plane_motions(&homography, &many).unwrap();
        assert_eq!(motions.iter().filter(|found| is_true(found)).count(), 1);
    }
}

#[test]
fn two_cameras_that_are_turned_round_see_a_plane_and_their_half_turn() {
    // Turned about each of its axes, with a wall or the ground on one side of both cameras.
    for (axis, ahead) in [(0, Vector3::x()), (1, Vector3::y()), (2, Vector3::z())] {
        let mut half_turn = -Matrix3::identity();
        half_turn[(axis, axis)] = 1.0;
        let shift = Vector3::new(0.3, 0.0, 10.0);
        let homography = half_turn + shift * ahead.transpose();
        for scale in [1.0, -2.0] {
            let motions = plane_motions(&(scale * homography), &[ahead]).unwrap();
            let is_true = |found: &vislam::robust_two_view::PlaneMotion| {
                (found.motion.rotation.matrix() - half_turn).amax() < 1e-9
                    && (found.motion.direction.into_inner() - shift.normalize()).amax() < 1e-9
            };
            assert_eq!(motions.iter().filter(|found| is_true(found)).count(), 1, "axis {axis}");
        }
    }
}

#[test]
fn a_step_towards_a_plane_is_one_motion_and_not_twice_the_same() {
    let homography = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.5));
    let motions = plane_motions(&homography, &[Vector3::z()]).unwrap();
    assert_eq!(motions.len(), 1);
    let found = motions.iter().next().unwrap();
    assert!((found.motion.direction.z - 1.0).abs() < 1e-12 && (found.baseline - 0.5).abs() < 1e-12);
}

#[test]
fn a_rotation_is_no_plane() {
    let pose = motion(&mut random(16));
    let rotation = pose.rotation.to_rotation_matrix().into_inner();
    assert_eq!(plane_motions(&(3.0 * rotation), &[]), Err(HomographyError::Turned));
}

#[test]
fn two_rays_give_the_rotation_and_one_does_not() {
    let mut random = random(17);
    for seed in 0..100 {
        let mut pose = motion(&mut random);
        let pairs = many(2, &pose, seed);
        pose.translation = Translation3::identity();
        let turned: Vec<RayPair> =
            pairs.iter().map(|(first, _)| (2.0 * first, pose.rotation * first)).collect();
        let found: Matrix3<f64> = rotation_of_rays(&turned).unwrap().into_inner();
        let truth = pose.rotation.to_rotation_matrix().into_inner();
        assert!((found - truth).amax() < 1e-9);
        assert_eq!(rotation_of_rays(&turned[..1]), None);
    }
    assert_eq!(rotation_of_rays(&[(Vector3::x(), Vector3::repeat(f64::NAN))]), None);
}
