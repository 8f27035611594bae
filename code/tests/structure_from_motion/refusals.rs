//! What cannot be reconstructed, and what is said then.

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use vislam::structure_from_motion::{
    PictureMatch, ReconstructionError, ReconstructionOptions, Refused, reconstruct, verify,
};

use super::scenes::{Scene, arc, ball, looking, random, scene};

fn small(seed: u64) -> Scene {
    let mut random = random(seed);
    let points = ball(100, &mut random);
    scene(arc(6), &points, 1.0, &mut random)
}

fn error(scene: &Scene) -> ReconstructionError {
    reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap_err()
}

fn registered(cameras: &[Result<Isometry3<f64>, Refused>]) -> Vec<usize> {
    (0..cameras.len()).filter(|picture| cameras[*picture].is_ok()).collect()
}

#[test]
fn numbers_that_are_none_are_refused_by_name() {
    let scene = small(31);
    let mut broken = scene.clone();
    broken.pictures[2].keypoints[5].y = f64::NAN;
    assert_eq!(error(&broken), ReconstructionError::Keypoint { picture: 2, keypoint: 5 });
    let mut broken = scene.clone();
    broken.pictures[1].camera.fx = 0.0;
    assert!(matches!(error(&broken), ReconstructionError::Camera { picture: 1, .. }));
    let mut broken = scene.clone();
    broken.matches[3].keypoints[1] = 1000;
    assert!(matches!(error(&broken), ReconstructionError::Match { at: 3, keypoint: 1000, .. }));
    let mut broken = scene.clone();
    broken.matches[3].pictures[0] = 6;
    assert!(matches!(error(&broken), ReconstructionError::Match { at: 3, picture: 6, .. }));
    let mut broken = scene.clone();
    broken.matches[4] = PictureMatch { pictures: [1, 1], keypoints: [0, 1] };
    assert_eq!(error(&broken), ReconstructionError::WithItself { at: 4, picture: 1 });
    let options = [
        ReconstructionOptions { sigma: 0.0, ..Default::default() },
        ReconstructionOptions { inlier_probability: 1.0, ..Default::default() },
        ReconstructionOptions { least_parallax: f64::NAN, ..Default::default() },
        ReconstructionOptions { first_parallax: -1.0, ..Default::default() },
        ReconstructionOptions { most_starts: 0, ..Default::default() },
    ];
    for options in options {
        let refused = reconstruct(&scene.pictures, &scene.matches, &options);
        assert!(matches!(refused, Err(ReconstructionError::Option { .. })));
        let refused = verify(&scene.pictures, &scene.matches, &options);
        assert!(matches!(refused, Err(ReconstructionError::Option { .. })));
    }
}

#[test]
fn nothing_and_next_to_nothing_give_no_map() {
    let none = reconstruct(&[], &[], &Default::default()).unwrap_err();
    assert!(matches!(none, ReconstructionError::NoFirstPair { pairs: 0, verified: 0, .. }));
    let few = small(32);
    let some = few.matches.iter().copied().step_by(40).collect();
    let few = Scene { matches: some, ..few };
    assert!(matches!(error(&few), ReconstructionError::NoFirstPair { verified: 0, .. }));
}

#[test]
fn matches_that_are_all_wrong_give_no_map() {
    let mut random = random(33);
    let scene = small(33);
    let right = scene.matches.len();
    let mut wrong = scene.with_wrong(0.5, &mut random);
    wrong.matches.drain(..right);
    assert!(matches!(error(&wrong), ReconstructionError::NoFirstPair { verified: 0, .. }));
}

#[test]
fn a_camera_that_only_turns_gives_no_map() {
    let mut random = random(34);
    let points = ball(200, &mut random);
    let first = looking(Vector3::new(0.0, 0.0, -8.0), Vector3::zeros());
    let turned = |k: usize| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.01, 0.03, 0.0) * k as f64);
        Isometry3::from_parts(Vector3::zeros().into(), turn) * first
    };
    let scene = scene((0..5).map(turned).collect(), &points, 1.0, &mut random);
    let ReconstructionError::NoFirstPair { pairs: 10, verified, narrow, rotations, .. } =
        error(&scene)
    else {
        panic!("{}", error(&scene));
    };
    assert_eq!((verified, narrow, rotations), (10, 10, 0));
}

#[test]
fn a_plane_gives_no_map_and_a_line_none_either() {
    let mut random = random(35);
    let mut points = ball(200, &mut random);
    points.iter_mut().for_each(|point| point.z = 0.2 * point.x - 0.1 * point.y);
    let flat = scene(arc(6), &points, 1.0, &mut random);
    let ReconstructionError::NoFirstPair { verified: 15, planes, .. } = error(&flat) else {
        panic!("{}", error(&flat));
    };
    assert!(planes > 5, "{planes}");
    points.iter_mut().for_each(|point| *point = Vector3::new(point.x, 0.3 * point.x, 0.2));
    let straight = scene(arc(6), &points, 1.0, &mut random);
    assert!(matches!(error(&straight), ReconstructionError::NoFirstPair { .. }));
}

#[test]
fn keypoints_that_are_all_the_same_give_no_map() {
    let mut scene = small(36);
    for picture in &mut scene.pictures {
        picture.keypoints.iter_mut().for_each(|pixel| *pixel = Vector2::new(100.0, 100.0));
    }
    assert!(matches!(error(&scene), ReconstructionError::NoFirstPair { .. }));
}

#[test]
fn a_picture_whose_matches_are_wrong_is_refused_and_the_others_are_not() {
    let mut random = random(37);
    let mut scene = small(37);
    let count = scene.pictures[4].keypoints.len();
    for one in scene.matches.iter_mut().filter(|one| one.pictures.contains(&4)) {
        let side = usize::from(one.pictures[1] == 4);
        one.keypoints[side] = rand::RngExt::random_range(&mut random, 0..count);
    }
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    assert_eq!(registered(&found.cameras), [0, 1, 2, 3, 5]);
    let refused = found.cameras[4].unwrap_err();
    assert!(matches!(refused, Refused::NoMatches | Refused::NoPose { .. }), "{refused}");
}

#[test]
fn of_two_scenes_without_a_match_between_them_the_larger_is_kept() {
    let mut random = random(38);
    let points = ball(200, &mut random);
    // The three of the smaller one see more points and with more parallax: the first pair is theirs.
    let poses = [arc(3), arc(7)].concat();
    let mut scene = scene(poses, &points, 1.0, &mut random);
    scene.matches.retain(|one| {
        let [a, b] = one.pictures;
        (a < 3) == (b < 3) && (a < 3 || one.keypoints[0] % 2 == 0)
    });
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    assert_eq!(registered(&found.cameras), (3..10).collect::<Vec<_>>());
    for camera in &found.cameras[..3] {
        assert!(matches!(camera, Err(Refused::FewPoints { seen: 0, .. })), "{camera:?}");
    }
}

/// Far points show hardly any parallax, so only the completion of a map places them.
#[test]
fn a_picture_that_sees_far_points_alone_joins_when_these_are_placed() {
    const NEAR: usize = 40;
    let mut random = random(40);
    let mut points = ball(NEAR, &mut random);
    let far = |k: usize| {
        let (column, row) = (k as f64 % 5.0 - 2.0, (k / 5) as f64 - 1.5);
        Vector3::new(60.0 * column, 60.0 * row, 450.0 + 20.0 * (k % 3) as f64)
    };
    points.extend((0..20).map(far));
    let poses = [-0.6, 0.6, 0.0].map(|x| looking(Vector3::new(x, 0.3 * x, -8.0), Vector3::zeros()));
    let scene = scene(poses.to_vec(), &points, 0.3, &mut random);
    let shown = scene.shown.clone();
    let scene = scene.only(|one| {
        let sees_far = |side: usize| shown[one.pictures[side]][one.keypoints[side]] >= NEAR;
        !one.pictures.contains(&2) || sees_far(0)
    });
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    assert_eq!(registered(&found.cameras), [0, 1, 2], "{:?}", found.cameras[2]);
    assert!(found.joined[2].seen > 6);
}

#[test]
fn a_picture_without_keypoints_is_refused() {
    let mut scene = small(39);
    scene.pictures[0].keypoints.clear();
    scene.matches.retain(|one| !one.pictures.contains(&0));
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    assert_eq!(registered(&found.cameras), [1, 2, 3, 4, 5]);
    assert_eq!(found.cameras[0], Err(Refused::NoMatches));
}
