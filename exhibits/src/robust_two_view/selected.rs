//! A turn, points that are far away, a wall, and depth: what agrees with which model, and what is chosen.

use std::sync::OnceLock;

use nalgebra::{Isometry3, Vector3};
use vislam::robust_two_view::{
    Consensus, ConsensusOptions, Matches, OnePlane, OnlyTurned, TwoViewModel, consensus,
    general_motion, motion_of_matches, select_model,
};

use super::scenes::{BASELINE, CAMERA, SIGMA, Scene, World};
use crate::chapter::Chapter;
use crate::random::Random;

pub const RIGHT: usize = 150;
pub const WRONG: usize = 50;
/// Times as far away are the points of the second pair.
const FAR: f64 = 400.0;

pub const NAMES: [&str; 4] = ["a turn", "far points", "a wall", "depth"];
pub const MODELS: [&str; 3] = ["rotation", "plane", "any motion"];

/// What came of one pair of pictures.
pub struct Judged {
    /// By model, the parts of the right and of the wrong matches within the gate.
    pub right: [f64; 3],
    pub wrong: [f64; 3],
    /// Which model was chosen.
    pub chosen: usize,
    /// How many motions of a plane there were.
    pub motions: usize,
    /// What the library says when it is asked for a motion, if it refuses.
    pub refusal: Option<String>,
}

fn scene(number: usize, seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let turn = random.rotation(0.15);
    let across = (Vector3::x() + random.direction(0.5)).normalize();
    let shift = if number == 0 { Vector3::zeros() } else { BASELINE * across };
    let world = [World::Deep, World::Far(FAR), World::Wall, World::Deep][number];
    let truth = Isometry3::from_parts(shift.into(), turn.into());
    Scene::of_motion(&mut random, truth, world, SIGMA, [RIGHT, WRONG])
}

fn parts<E>(found: Option<&Consensus<E>>) -> [f64; 2] {
    let Some(found) = found else { return [0.0; 2] };
    let right = found.inliers.iter().filter(|datum| **datum < RIGHT).count();
    [right as f64 / RIGHT as f64, (found.inliers.len() - right) as f64 / WRONG as f64]
}

fn judged(number: usize) -> Judged {
    let scene = scene(number, 900 + number as u64);
    let matches: Matches = scene.matches();
    let options = ConsensusOptions::default();
    let of = [
        parts(consensus(&OnlyTurned(&matches), &options).ok().as_ref()),
        parts(consensus(&OnePlane(&matches), &options).ok().as_ref()),
        parts(general_motion(&matches, &options).ok().as_ref()),
    ];
    let (chosen, motions) = chosen(&matches, &options);
    let refusal = motion_of_matches(&matches, &options).err().map(|refusal| refusal.to_string());
    Judged {
        right: of.map(|[right, _]| right),
        wrong: of.map(|[_, wrong]| wrong),
        chosen,
        motions,
        refusal,
    }
}

fn chosen(matches: &Matches, options: &ConsensusOptions) -> (usize, usize) {
    match select_model(matches, options).expect("right matches are the most") {
        TwoViewModel::Rotation(_) => (0, 0),
        TwoViewModel::Plane { motions, .. } => (1, motions.len()),
        TwoViewModel::General(_) => (2, 1),
    }
}

/// What came of each pair.
pub fn all() -> &'static [Judged; 4] {
    static ALL: OnceLock<[Judged; 4]> = OnceLock::new();
    ALL.get_or_init(|| std::array::from_fn(judged))
}

/// Pairs of each kind that are judged for the numbers.
const PAIRS: u64 = 5;
/// The model that is true of each kind, as far as its pixels tell.
const TRUE: [usize; 4] = [0, 0, 1, 2];

pub fn numbers(chapter: &mut Chapter) {
    let all = all();
    assert!(all.iter().zip(TRUE).all(|(judged, model)| judged.chosen == model), "as the text says");
    assert!(all[..3].iter().all(|judged| judged.refusal.is_some()), "no motion of those");
    let percent =
        |name, part: f64, chapter: &mut Chapter| chapter.number(name, 100.0 * part, "%", 0);
    percent("turn_by_rotation", all[0].right[0], chapter);
    percent("turn_by_plane", all[0].right[1], chapter);
    percent("turn_by_motion", all[0].right[2], chapter);
    chapter.number("wall_motions", all[2].motions as f64, "", 0);
    chapter.number("selected_right", RIGHT as f64, "", 0);
    chapter.number("selected_wrong", WRONG as f64, "", 0);
    chapter.number("far_least", FAR * super::scenes::DEPTHS[0], "m", 0);
    let most = CAMERA.fx * BASELINE / (FAR * super::scenes::DEPTHS[0]);
    chapter.number("far_parallax", most, "px", 2);
    let options = ConsensusOptions::default();
    let wrongly = (0..4 * PAIRS).filter(|pair| {
        let kind = (pair % 4) as usize;
        chosen(&scene(kind, 1000 + pair).matches(), &options).0 != TRUE[kind]
    });
    chapter.number("selected_pairs", 4.0 * PAIRS as f64, "", 0);
    chapter.number("selected_wrongly", wrongly.count() as f64, "", 0);
}
