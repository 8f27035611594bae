//! The error of a motion over the share of wrong matches.

use std::f64::consts::PI;

use vislam::robust_two_view::{ConsensusOptions, general_motion};

use super::scenes::{SIGMA, Scene, World, quantile};
use super::worked::fitting_all;
use crate::chapter::Chapter;
use crate::comparison::as_far_as;
use crate::random::Random;
use crate::record::{RecordValue, accepted};

/// Percent of wrong matches.
pub const SHARES: [usize; 9] = [0, 10, 20, 30, 40, 50, 60, 70, 80];
/// Right matches, whatever the share.
const RIGHT: usize = 100;
const SCENES: u64 = 100;
const RECORD: &str = "wrong_matches";

/// What is done about wrong matches.
pub const WAYS: [&str; 4] = ["oracle", "consensus", "unoptimized", "all"];

/// The name of a value: the median or the 95th percentile of a way at a share.
fn name(way: usize, share: usize, part: &str) -> String {
    format!("{}_{share}_{part}", WAYS[way])
}

/// A median in degrees, of the accepted record.
pub fn median(way: usize, share: usize) -> f64 {
    accepted(RECORD, &name(way, share, "median"))
}

/// By way, the errors in degrees.
fn errors(share: usize) -> [Vec<f64>; 4] {
    let wrong = RIGHT * share / (100 - share);
    let mut errors: [Vec<f64>; 4] = Default::default();
    for number in 0..SCENES {
        let mut random = Random::new(1000 * share as u64 + number);
        let scene = Scene::new(&mut random, World::Deep, SIGMA, RIGHT, wrong);
        let matches = scene.matches();
        let options = ConsensusOptions { seed: number, ..Default::default() };
        let plain = ConsensusOptions { local_optimization: false, ..options };
        let found = [
            Some(scene.of_oracle()),
            general_motion(&matches, &options).ok().map(|found| found.estimate),
            general_motion(&matches, &plain).ok().map(|found| found.estimate),
            fitting_all(&scene),
        ];
        for (errors, found) in errors.iter_mut().zip(found) {
            // Where there is nothing, nothing is known.
            errors.push(found.map_or(180.0, |motion| scene.degrees_off(&motion)));
        }
    }
    errors
}

pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("scenes", format!("{SCENES} for each share")),
        ("right matches", RIGHT.to_string()),
        ("noise", format!("{SIGMA} px")),
    ];
    chapter.record(RECORD, inputs, || {
        let mut values = Vec::new();
        for share in SHARES {
            for (way, errors) in errors(share).into_iter().enumerate() {
                for (part, of) in [("median", 0.5), ("most", 0.95)] {
                    let value = quantile(errors.clone(), of);
                    values.push(RecordValue::new(name(way, share, part), value, "°", 2, 0.05));
                }
            }
        }
        values
    });
}

pub fn numbers(chapter: &mut Chapter) {
    let of = |name: String| accepted(RECORD, &name);
    chapter.number("share_scenes", SCENES as f64, "", 0);
    chapter.number("share_right", RIGHT as f64, "", 0);
    chapter.number("guess_median", guess_median().to_degrees(), "°", 0);
    chapter.number("share_all_none", median(3, 0), "°", 2);
    chapter.number("share_all_ten", median(3, 10), "°", 0);
    chapter.number("share_oracle", median(0, 60), "°", 2);
    chapter.number("share_found_20", median(1, 20), "°", 2);
    chapter.number("share_found_60", median(1, 60), "°", 2);
    chapter.number("share_found_80", median(1, 80), "°", 2);
    chapter.number("share_found_80_most", of(name(1, 80, "most")), "°", 1);
    chapter.number("share_plain_60_most", of(name(2, 60, "most")), "°", 1);
    chapter.number("share_found_60_most", of(name(1, 60, "most")), "°", 1);
}

/// Below this angle lies half of the errors of motions drawn at random, each the larger one of its rotation's and its
/// direction's.
fn guess_median() -> f64 {
    let below = |angle: f64| (angle - angle.sin()) / PI * (1.0 - angle.cos()) / 2.0;
    as_far_as(0.0, PI, |angle| below(angle) < 0.5)
}
