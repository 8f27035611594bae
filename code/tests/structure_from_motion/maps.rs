//! Maps of simulated pictures.

use vislam::manifold::se3;
use vislam::structure_from_motion::{
    Adjustments, Picture, PictureMatch, ReconstructionOptions, reconstruct,
};

use super::scenes::{Scene, arc, ball, random, scene, shuffle, street};

/// Twelve cameras, 300 points, noise of a pixel, and a fifth of the matches wrong.
fn worked(seed: u64) -> Scene {
    let mut random = random(seed);
    let points = ball(300, &mut random);
    scene(arc(12), &points, 1.0, &mut random).with_wrong(0.2, &mut random)
}

// ANCHOR: worked_example
#[test]
fn matches_of_which_a_fifth_is_wrong_become_cameras_and_points() {
    for seed in 0..3 {
        let scene = worked(seed);

        let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();

        assert_eq!(found.cameras.iter().flatten().count(), 12);
        assert!(scene.largest_error(&found) < 0.05, "{}", scene.largest_error(&found));
        assert!((295..=330).contains(&found.points.len()), "{} points", found.points.len());
    }
}
// ANCHOR_END: worked_example

#[test]
fn the_points_of_a_map_show_one_point_each() {
    let scene = worked(4);
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    let (mut mixed, mut sightings) = (0, 0);
    for point in &found.points {
        let mut pictures: Vec<usize> = point.sightings.iter().map(|[p, _]| *p).collect();
        pictures.dedup();
        assert_eq!(pictures.len(), point.sightings.len());
        assert!(point.sightings.len() >= 2);
        for [picture, keypoint] in &point.sightings {
            let Picture { camera, keypoints } = &scene.pictures[*picture];
            let pose = found.cameras[*picture].as_ref().unwrap();
            let off = camera.project(pose, &point.place).unwrap() - keypoints[*keypoint];
            assert!(off.norm() < 4.0);
        }
        let shown = |[picture, keypoint]: &[usize; 2]| scene.shown[*picture][*keypoint];
        let first = shown(&point.sightings[0]);
        mixed += usize::from(point.sightings.iter().any(|one| shown(one) != first));
        sightings += point.sightings.len();
    }
    assert!(mixed <= 3, "{mixed} points of two");
    let all: usize = scene.pictures.iter().map(|picture| picture.keypoints.len()).sum();
    assert!(sightings as f64 > 0.995 * all as f64, "{sightings} of {all}");
}

#[test]
fn the_noise_that_is_left_is_the_noise_that_was_put_in() {
    let mut random = random(5);
    let points = ball(300, &mut random);
    let scene = scene(arc(12), &points, 0.5, &mut random);
    let options = ReconstructionOptions { sigma: 0.5, ..Default::default() };
    let found = reconstruct(&scene.pictures, &scene.matches, &options).unwrap();
    let (mut sum, mut count) = (0.0, 0);
    for point in &found.points {
        for [picture, keypoint] in &point.sightings {
            let Picture { camera, keypoints } = &scene.pictures[*picture];
            let pose = found.cameras[*picture].as_ref().unwrap();
            let off = camera.project(pose, &point.place).unwrap() - keypoints[*keypoint];
            (sum, count) = (sum + off.norm_squared(), count + 2);
        }
    }
    let freedom = count - 3 * found.points.len() - (6 * 12 - 7);
    let sigma = (sum / freedom as f64).sqrt();
    assert!((sigma - 0.5).abs() < 0.01, "{sigma}");
}

#[test]
fn the_order_of_pictures_keypoints_and_matches_does_not_matter() {
    let scene = worked(6);
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    let mut random = random(7);
    for _ in 0..2 {
        let mut picture_order: Vec<usize> = (0..12).collect();
        shuffle(&mut picture_order, &mut random);
        let mut new_picture = [0; 12];
        picture_order.iter().enumerate().for_each(|(at, from)| new_picture[*from] = at);
        let mut pictures = Vec::new();
        let mut new_keypoint = vec![Vec::new(); 12];
        for from in &picture_order {
            let Picture { camera, keypoints } = &scene.pictures[*from];
            let mut order: Vec<usize> = (0..keypoints.len()).collect();
            shuffle(&mut order, &mut random);
            new_keypoint[*from] = vec![0; order.len()];
            order.iter().enumerate().for_each(|(at, k)| new_keypoint[*from][*k] = at);
            let keypoints = order.iter().map(|k| keypoints[*k]).collect();
            pictures.push(Picture { camera: *camera, keypoints });
        }
        let mut matches: Vec<PictureMatch> = scene
            .matches
            .iter()
            .enumerate()
            .map(|(at, PictureMatch { pictures: [a, b], keypoints: [i, j] })| {
                let one = (new_picture[*a], new_keypoint[*a][*i]);
                let other = (new_picture[*b], new_keypoint[*b][*j]);
                let (one, other) = if at % 2 == 0 { (one, other) } else { (other, one) };
                PictureMatch { pictures: [one.0, other.0], keypoints: [one.1, other.1] }
            })
            .collect();
        shuffle(&mut matches, &mut random);
        let other = reconstruct(&pictures, &matches, &Default::default()).unwrap();
        for (from, camera) in found.cameras.iter().enumerate() {
            assert_eq!(camera, &other.cameras[new_picture[from]]);
        }
        assert_eq!(found.points.len(), other.points.len());
        for (one, other) in found.points.iter().zip(&other.points) {
            assert_eq!(one.place, other.place);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_map_and_another_one_the_same_cameras() {
    let scene = worked(8);
    let with = |seed: u64| {
        let options = ReconstructionOptions { seed, ..Default::default() };
        reconstruct(&scene.pictures, &scene.matches, &options).unwrap()
    };
    let (one, again, other) = (with(1), with(1), with(2));
    assert_eq!(one, again);
    assert!(scene.largest_error(&other) < 0.05);
}

#[test]
fn a_long_street_drifts_less_with_every_adjustment() {
    let mut random = random(9);
    let scene = street(40, 1500, &mut random);
    let error = |adjustments: Adjustments| {
        let options = ReconstructionOptions { adjustments, ..Default::default() };
        let found = reconstruct(&scene.pictures, &scene.matches, &options).unwrap();
        assert_eq!(found.cameras.iter().flatten().count(), 40);
        scene.largest_error(&found)
    };
    let [none, local, global] =
        [Adjustments::None, Adjustments::Local, Adjustments::LocalAndGlobal].map(error);
    assert!(none > 2.0 * local && local > global, "{none} {local} {global}");
    assert!(global < 0.5, "{global}");
}

#[test]
fn two_cameras_at_the_same_place_do_not_hinder_the_others() {
    let mut random = random(10);
    let points = ball(300, &mut random);
    let mut poses = arc(8);
    let turn = se3::exp(&nalgebra::Vector6::new(0.0, 0.0, 0.0, 0.02, 0.05, 0.3));
    poses.push(turn * poses[3]);
    let scene = scene(poses, &points, 1.0, &mut random).with_wrong(0.2, &mut random);
    let found = reconstruct(&scene.pictures, &scene.matches, &Default::default()).unwrap();
    assert_eq!(found.cameras.iter().flatten().count(), 9);
    assert!(scene.largest_error(&found) < 0.05);
}
