//! Rotation, plane, or any motion.

use nalgebra::{Isometry3, Vector2, Vector3};
use vislam::robust_two_view::{
    ConsensusError, ConsensusOptions, Matches, NoMotion, TwoViewModel, motion_of_matches,
    select_model,
};

use super::scenes::{CAMERA, World, any_pixel, pixels, random, small_motion};

fn selected(pixels: &[[Vector2<f64>; 2]], seed: u64) -> TwoViewModel {
    let matches = Matches::new([&CAMERA, &CAMERA], pixels, 1.0).unwrap();
    select_model(&matches, &ConsensusOptions { seed, ..Default::default() }).unwrap()
}

const SCENES: u64 = 30;

#[test]
fn a_model_is_chosen_by_a_probability_below_one() {
    let matches = Matches::new([&CAMERA, &CAMERA], &[], 1.0).unwrap();
    let options = ConsensusOptions { false_alarms: 1.0, ..Default::default() };
    let refused = select_model(&matches, &options).unwrap_err();
    assert_eq!(refused, ConsensusError::Probability { name: "false_alarms", value: 1.0 });
}

#[test]
fn a_camera_that_only_turned_is_told_from_one_that_moved() {
    let mut random = random(41);
    let (mut turned, mut moved) = (0, 0);
    for seed in 0..SCENES {
        let mut pose = small_motion(&mut random);
        let general = pixels(&mut random, &pose, World::Deep, 150, 100);
        moved += usize::from(matches!(selected(&general, seed), TwoViewModel::General(_)));
        pose.translation.vector = Vector3::zeros();
        let only_turned = pixels(&mut random, &pose, World::Deep, 150, 100);
        turned += usize::from(matches!(selected(&only_turned, seed), TwoViewModel::Rotation(_)));
    }
    assert_eq!(moved, 30);
    assert!(turned >= 28, "{turned}");
}

#[test]
fn a_plane_is_told_from_depth_and_from_a_turn_and_has_the_true_motion() {
    let mut random = random(42);
    let (mut planes, mut true_motions) = (0, 0);
    for seed in 0..SCENES {
        let pose = small_motion(&mut random);
        let flat = pixels(&mut random, &pose, World::Flat, 150, 100);
        if let TwoViewModel::Plane { motions, .. } = selected(&flat, seed) {
            planes += 1;
            let off = |found: &vislam::robust_two_view::PlaneMotion| {
                found.motion.direction.angle(&pose.translation.vector).to_degrees()
            };
            true_motions += usize::from(motions.iter().any(|found| off(found) < 5.0));
        }
    }
    assert!(planes >= 28, "{planes}");
    assert!(true_motions >= planes - 1, "{true_motions} of {planes}");
}

#[test]
fn a_few_points_beside_the_plane_are_enough_for_a_general_motion() {
    let mut random = random(43);
    let mut general = 0;
    for seed in 0..SCENES {
        let pose = small_motion(&mut random);
        let mut all = pixels(&mut random, &pose, World::Flat, 150, 100);
        all.extend(pixels(&mut random, &pose, World::Deep, 30, 0));
        general += usize::from(matches!(selected(&all, seed), TwoViewModel::General(_)));
    }
    assert!(general >= 28, "{general}");
}

#[test]
fn a_motion_beside_far_points_is_told_from_a_turn_however_rare_false_alarms_are_to_be() {
    let mut random = random(46);
    for seed in 0..5 {
        let pose = small_motion(&mut random);
        let turn = Isometry3::from_parts(Vector3::zeros().into(), pose.rotation);
        let mut all = pixels(&mut random, &turn, World::Deep, 60, 0);
        all.extend(pixels(&mut random, &pose, World::Deep, 140, 0));
        let matches = Matches::new([&CAMERA, &CAMERA], &all, 1.0).unwrap();
        for false_alarms in [1e-3, 1e-17] {
            let options = ConsensusOptions { seed, false_alarms, ..Default::default() };
            let found = motion_of_matches(&matches, &options).unwrap();
            assert!(found.inliers.len() > 130, "{}", found.inliers.len());
        }
    }
}

#[test]
fn a_baseline_that_noise_hides_is_a_turn_and_one_that_it_does_not_is_a_motion() {
    let mut random = random(44);
    let (mut hidden, mut shown) = (0, 0);
    for seed in 0..SCENES {
        let mut pose = small_motion(&mut random);
        let mut with = |baseline: f64| {
            pose.translation.vector = pose.translation.vector.normalize() * baseline;
            selected(&pixels(&mut random, &pose, World::Deep, 150, 50), seed)
        };
        // At a depth of four a pixel is 8 mm.
        hidden += usize::from(matches!(with(2e-4), TwoViewModel::Rotation(_)));
        shown += usize::from(!matches!(with(0.1), TwoViewModel::Rotation(_)));
    }
    assert!(hidden >= 28, "{hidden}");
    assert_eq!(shown, 30);
}

#[test]
fn a_refusal_says_which_model_explains_the_matches() {
    let mut random = random(45);
    let options = ConsensusOptions::default();
    let refused = |pixels: &[[Vector2<f64>; 2]]| {
        let matches = Matches::new([&CAMERA, &CAMERA], pixels, 1.0).unwrap();
        motion_of_matches(&matches, &options)
    };
    let pose = small_motion(&mut random);
    let turn = Isometry3::from_parts(Vector3::zeros().into(), pose.rotation);
    let turned = refused(&pixels(&mut random, &turn, World::Deep, 100, 0)).unwrap_err();
    assert!(matches!(turned, NoMotion::Rotation { inliers: 90.., .. }));
    assert!(turned.to_string().contains("only turned"));
    let flat = refused(&pixels(&mut random, &pose, World::Flat, 100, 0)).unwrap_err();
    assert!(matches!(&flat, NoMotion::Plane { motions } if !motions.is_empty()));
    assert!(flat.to_string().contains("one plane"));
    let wrong: Vec<_> = (0..60).map(|_| [any_pixel(&mut random), any_pixel(&mut random)]).collect();
    let quick = ConsensusOptions { most_draws: 500, ..options };
    let matches = Matches::new([&CAMERA, &CAMERA], &wrong, 1.0).unwrap();
    let none = motion_of_matches(&matches, &quick).unwrap_err();
    assert!(matches!(none, NoMotion::None(ConsensusError::Chance { .. })), "{none}");
    assert!(refused(&pixels(&mut random, &pose, World::Deep, 100, 0)).is_ok());
}
