//! Matches that are tried pair by pair, and joined.

use vislam::structure_from_motion::{PictureMatch, Tracks, join_matches, verify};

use super::scenes::{Scene, arc, ball, random, scene, street};

fn worked(wrong: f64) -> Scene {
    let mut random = random(21);
    let points = ball(200, &mut random);
    scene(arc(8), &points, 1.0, &mut random).with_wrong(wrong, &mut random)
}

/// How many tracks hold all keypoints of a point, and nothing else.
fn whole(scene: &Scene, tracks: &Tracks) -> usize {
    let shown = |[picture, keypoint]: &[usize; 2]| scene.shown[*picture][*keypoint];
    let views = |point: usize| scene.shown.iter().flatten().filter(|p| **p == point).count();
    let is_whole = |track: &&Vec<[usize; 2]>| {
        let point = shown(&track[0]);
        track.len() == views(point) && track.iter().all(|one| shown(one) == point)
    };
    tracks.tracks.iter().filter(is_whole).count()
}

#[test]
fn right_matches_make_a_track_of_each_point() {
    let scene = worked(0.0);
    let tracks = join_matches(&scene.pictures, &scene.matches).unwrap();
    assert_eq!((whole(&scene, &tracks), tracks.tracks.len(), tracks.refused), (200, 200, 0));
}

#[test]
fn verification_keeps_what_is_right_and_one_in_a_hundred_of_what_is_wrong() {
    let scene = worked(0.2);
    let verified = verify(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    let is_right = |one: &&PictureMatch| {
        let [a, b] = [0, 1].map(|side| scene.shown[one.pictures[side]][one.keypoints[side]]);
        a == b
    };
    let right = scene.matches.iter().filter(is_right).count();
    let kept = verified.iter().filter(is_right).count();
    assert!(kept as f64 > 0.998 * right as f64, "{kept} of {right}");
    let (wrong, left) = (scene.matches.len() - right, verified.len() - kept);
    assert!(left as f64 <= 0.03 * wrong as f64, "{left} of {wrong}");
}

#[test]
fn tracks_of_unverified_matches_do_not_survive() {
    let mut random = random(22);
    let scene = street(20, 600, &mut random).with_wrong(0.2, &mut random);
    let verified = verify(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    let right = scene.right_matches();
    let [all, after, before] = [&right, &verified, &scene.matches]
        .map(|matches| whole(&scene, &join_matches(&scene.pictures, matches).unwrap()));
    assert!(after as f64 > 0.9 * all as f64, "{after} of {all}");
    assert!((before as f64) < 0.5 * all as f64, "{before} of {all}");
}

#[test]
fn a_match_that_contradicts_three_that_agree_is_refused() {
    let scene = worked(0.0).only(|one| one.pictures.iter().all(|picture| *picture < 3));
    let whole = join_matches(&scene.pictures, &scene.matches).unwrap();
    let track = whole.tracks.iter().find(|track| track.len() == 3).unwrap();
    let other = whole.tracks.iter().rfind(|track| track.len() == 3).unwrap();
    let mut matches = scene.matches.clone();
    // First in the list, and no help to it.
    let [[a, i], [b, j]] = [track[0], other[1]];
    matches.insert(0, PictureMatch { pictures: [a, b], keypoints: [i, j] });
    let found = join_matches(&scene.pictures, &matches).unwrap();
    assert_eq!((found.tracks, found.refused), (whole.tracks, 1));
}

#[test]
fn matches_that_are_said_twice_or_the_other_way_round_are_one() {
    let scene = worked(0.1);
    let mut matches = scene.matches.clone();
    matches.extend(scene.matches.iter().map(|one| PictureMatch {
        pictures: [one.pictures[1], one.pictures[0]],
        keypoints: [one.keypoints[1], one.keypoints[0]],
    }));
    let both = join_matches(&scene.pictures, &matches).unwrap();
    assert_eq!(both, join_matches(&scene.pictures, &scene.matches).unwrap());
}
