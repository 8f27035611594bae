//! One pair of pictures with 300 wrong matches among 500.

use vislam::robust_two_view::{
    ConsensusOptions, Correspondences, Effort, GeneralMotion, RelativeMotion, eight_points,
    general_motion,
};
use vislam::two_views::relative_pose;

use super::scenes::{BASELINE, SIGMA, Scene, World};
use crate::chapter::Chapter;
use crate::random::Random;

pub const RIGHT: usize = 200;
pub const WRONG: usize = 300;

/// The motion that fits all matches best, wrong ones among them, from where the eight-point method begins.
pub fn fitting_all(scene: &Scene) -> Option<RelativeMotion> {
    let matches = scene.matches();
    let essential = eight_points(matches.rays()).ok()?;
    let (start, _) = relative_pose(&essential, matches.rays()).ok()?;
    let all: Vec<usize> = (0..matches.len()).collect();
    GeneralMotion(&matches).refined(&RelativeMotion::of(&start)?, &all, Effort::Converge)
}

pub fn numbers(chapter: &mut Chapter) {
    let scene = Scene::new(&mut Random::new(70), World::Deep, SIGMA, RIGHT, WRONG);
    let found = general_motion(&scene.matches(), &ConsensusOptions::default())
        .expect("two hundred right matches");
    let right = found.inliers.iter().filter(|datum| **datum < RIGHT).count();
    chapter.number("matches", (RIGHT + WRONG) as f64, "", 0);
    chapter.number("right", RIGHT as f64, "", 0);
    chapter.number("wrong", WRONG as f64, "", 0);
    chapter.number("wrong_percent", 100.0 * WRONG as f64 / (RIGHT + WRONG) as f64, "%", 0);
    chapter.number("noise_px", SIGMA, "px", 0);
    chapter.number("baseline_m", BASELINE, "m", 1);
    let off = fitting_all(&scene).map_or(f64::NAN, |motion| scene.degrees_off(&motion));
    chapter.number("all_off", off, "°", 0);
    chapter.number("found_off", scene.degrees_off(&found.estimate), "°", 2);
    chapter.number("oracle_off", scene.degrees_off(&scene.of_oracle()), "°", 2);
    chapter.number("found_right", right as f64, "", 0);
    chapter.number("found_wrong", (found.inliers.len() - right) as f64, "", 0);
    let by_chance = found.by_chance * WRONG as f64 / (RIGHT + WRONG) as f64;
    chapter.number("by_chance", by_chance, "", 1);
    chapter.number("found_draws", found.draws as f64, "", 0);
    let options = ConsensusOptions::default();
    chapter.number("patience", options.patience, "", 0);
    chapter.number("inlier_percent", 100.0 * options.inlier_probability, "%", 0);
    chapter.number("confidence_percent", 100.0 * options.confidence, "%", 2);
}
