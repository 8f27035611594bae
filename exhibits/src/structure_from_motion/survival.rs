//! How many tracks survive wrong matches.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use vislam::structure_from_motion::{PictureMatch, join_matches, verify};

use super::street::{Street, street};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Untouched); 3] = [
        ("one end of a wrong match", |views, wrong| untouched(views, wrong).sqrt()),
        ("as many as views, not as pairs", |views, wrong| (-views * wrong / (1.0 - wrong)).exp()),
        ("every keypoint like the first", |views, wrong| untouched(2.0, wrong).powf(views / 2.0)),
    ];
    chapter.equation("track-survival", track_survival, untouched, &mutants);
    chapter.number("untouched_four", 100.0 * untouched(4.0, 0.2), "%", 0);
    chapter.number("untouched_two", 100.0 * untouched(2.0, 0.2), "%", 0);
    let at = |way: usize| 100.0 * all()[way][FIFTH];
    chapter.number("survive_plain", at(0), "%", 0);
    chapter.number("survive_refused", at(1), "%", 0);
    chapter.number("survive_verified", at(2), "%", 0);
}

/// Views of a track and the share of wrong matches: the probability that none of its keypoints has one.
type Untouched = fn(f64, f64) -> f64;

fn untouched(views: f64, wrong: f64) -> f64 {
    (-views * (views - 1.0) * wrong / (1.0 - wrong)).exp()
}

/// Pictures and points of a world in which every point is seen so often.
const PICTURES: usize = 30;
const POINTS: usize = 6000;

fn track_survival(formula: Untouched) -> Comparison {
    let against = "tracks in random pictures, with matches drawn at random among them";
    Comparison::absolute(against, 0.02, "share").over(20, 11, |random| {
        let views = random.uniform(2.0..5.0) as usize;
        let wrong = random.uniform(0.02..0.25);
        (formula(views as f64, wrong), simulated(views, wrong, random))
    })
}

/// The share of tracks that no wrong match touches, when these are drawn as right ones are spread over pairs.
fn simulated(views: usize, wrong: f64, random: &mut Random) -> f64 {
    let mut seen = vec![Vec::new(); PICTURES];
    let mut pairs: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for point in 0..POINTS {
        let mut pictures = BTreeSet::new();
        while pictures.len() < views {
            pictures.insert(random.uniform(0.0..PICTURES as f64) as usize);
        }
        let pictures: Vec<usize> = pictures.into_iter().collect();
        for (at, b) in pictures.iter().enumerate() {
            seen[*b].push(point);
            pictures[..at].iter().for_each(|a| *pairs.entry([*a, *b]).or_default() += 1);
        }
    }
    let mut is_touched = vec![false; POINTS];
    let mut due = 0.0;
    for (pair, right) in pairs {
        due += right as f64 * wrong / (1.0 - wrong);
        while due >= 1.0 {
            due -= 1.0;
            for picture in pair {
                let at = random.uniform(0.0..seen[picture].len() as f64) as usize;
                is_touched[seen[picture][at]] = true;
            }
        }
    }
    is_touched.iter().filter(|touched| !**touched).count() as f64 / POINTS as f64
}

pub const SHARES: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.3, 0.4];
const FIFTH: usize = 3;
pub const WAYS: [&str; 3] = ["all joined", "contradictions refused", "verified, then joined"];

/// By way and by share of wrong matches, the share of tracks that hold all keypoints of a point, and no other.
pub fn all() -> &'static [[f64; SHARES.len()]; WAYS.len()] {
    static ALL: OnceLock<[[f64; SHARES.len()]; WAYS.len()]> = OnceLock::new();
    ALL.get_or_init(|| {
        let of = SHARES.map(|share| {
            let mut random = Random::new(5);
            let street = street(24, 900, &mut random).with_wrong(share, &mut random);
            ways(&street)
        });
        std::array::from_fn(|way| of.map(|of| of[way]))
    })
}

fn ways(street: &Street) -> [f64; WAYS.len()] {
    let verified = verify(&street.pictures, &street.matches, &Default::default()).expect("numbers");
    let joined =
        |matches: &[PictureMatch]| join_matches(&street.pictures, matches).expect("numbers").tracks;
    [
        street.whole(&components(street)),
        street.whole(&joined(&street.matches)),
        street.whole(&joined(&verified)),
    ]
}

/// Keypoints that any matches connect.
fn components(street: &Street) -> Vec<Vec<[usize; 2]>> {
    let mut group: BTreeMap<[usize; 2], [usize; 2]> = BTreeMap::new();
    fn root(group: &BTreeMap<[usize; 2], [usize; 2]>, mut at: [usize; 2]) -> [usize; 2] {
        while let Some(next) = group.get(&at) {
            at = *next;
        }
        at
    }
    for PictureMatch { pictures: [a, b], keypoints: [i, j] } in &street.matches {
        let (one, other) = (root(&group, [*a, *i]), root(&group, [*b, *j]));
        if one != other {
            group.insert(one, other);
        }
    }
    let mut components: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for (picture, shown) in street.shown.iter().enumerate() {
        for keypoint in 0..shown.len() {
            let own = [picture, keypoint];
            components.entry(root(&group, own)).or_default().push(own);
        }
    }
    components.into_values().filter(|one| one.len() > 1).collect()
}
