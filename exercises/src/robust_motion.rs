//! Four in ten are wrong. Edition 1.
//!
//! `cargo test -p exercises robust_motion`

use exercise_spec::robust_motion::{Camera, Match};
use nalgebra::Isometry3;

/// How many samples have to be drawn so that with probability `confidence`, or a larger one,
/// at least one of them gives a good motion. Each sample is drawn anew and consists of
/// `sample` **different** matches, of which `right` out of `matches` are right. A sample gives
/// a good motion when all of it is right **and** its noise is kind, which happens to a part
/// `useful` of the samples that are all right. There are `sample` right matches or more, some
/// are wrong, and `useful` and `confidence` lie between zero and one.
pub fn draws(right: usize, matches: usize, sample: usize, useful: f64, confidence: f64) -> usize {
    let _ = (right, matches, sample, useful, confidence);
    todo!("with which probability is one sample a good one, and do all of them fail?")
}

/// The squared error of each match in **variances**: the square of the left side of the
/// epipolar constraint over the variance that the noise of both pixels gives it, to first
/// order. The motion takes coordinates in the first camera to those in the second; its
/// translation is not zero, and how long it is does not matter.
pub fn squared_errors(
    first: Camera,
    second: Camera,
    second_from_first: Isometry3<f64>,
    matches: Vec<Match>,
) -> Vec<f64> {
    let _ = (first, second, second_from_first, matches);
    todo!("what does the noise of four numbers do to the left side of the constraint?")
}

/// The score of a motion, which is better when it is smaller: the sum of the squared errors of
/// all matches, each of them counted as at most the gate.
pub fn score(squared_errors: Vec<f64>, gate: f64) -> f64 {
    let _ = (squared_errors, gate);
    todo!("what does a match cost that is far beyond the gate?")
}

/// How many motions, of `tried` ones that have nothing to do with the matches, would on
/// average have `agree` matches **or more** within the gate. Each of the `matches` is there with
/// probability `chance`, independently of all others.
pub fn false_alarms(agree: usize, matches: usize, chance: f64, tried: usize) -> f64 {
    let _ = (agree, matches, chance, tried);
    todo!("how probable are so many or more, and how often was it tried?")
}

/// The place in `motions` of the one with the least score. `None` when that could be luck:
/// when the number of false alarms, for as many matches as have a squared error of at most the
/// gate and for as many motions as were tried, is more than `most_alarms`.
pub fn chosen_motion(
    first: Camera,
    second: Camera,
    motions: Vec<Isometry3<f64>>,
    matches: Vec<Match>,
    gate: f64,
    chance: f64,
    most_alarms: f64,
) -> Option<usize> {
    let _ = (first, second, motions, matches, gate, chance, most_alarms);
    todo!("which motion has the least score, and could it be luck?")
}
