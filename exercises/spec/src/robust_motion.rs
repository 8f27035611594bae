//! Four matches in ten are wrong: which of many motions to believe, or none.

use nalgebra::{Isometry3, Vector2};
use serde::{Deserialize, Serialize};

pub use crate::camera::Camera;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: matched
/// Two pixels that are said to show one point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Match {
    /// The pixel in the first picture.
    pub first: Vector2<f64>,
    /// The pixel in the second picture.
    pub second: Vector2<f64>,
    /// The standard deviation of each coordinate of the first pixel, in pixels, if the match is
    /// right.
    pub sigma_first: f64,
    /// That of the second pixel, which is another one.
    pub sigma_second: f64,
}
// ANCHOR_END: matched

crate::signatures! {
    // ANCHOR: drawing
    /// How many samples have to be drawn so that with probability `confidence`, or a larger one,
    /// at least one of them gives a good motion. Each sample is drawn anew and consists of
    /// `sample` **different** matches, of which `right` out of `matches` are right. A sample gives
    /// a good motion when all of it is right **and** its noise is kind, which happens to a part
    /// `useful` of the samples that are all right. There are `sample` right matches or more, some
    /// are wrong, and `useful` and `confidence` lie between zero and one.
    fn draws(right: usize, matches: usize, sample: usize, useful: f64, confidence: f64) -> usize;
    // ANCHOR_END: drawing

    // ANCHOR: judging
    /// The squared error of each match in **variances**: the square of the left side of the
    /// epipolar constraint over the variance that the noise of both pixels gives it, to first
    /// order. The motion takes coordinates in the first camera to those in the second; its
    /// translation is not zero, and how long it is does not matter.
    fn squared_errors(
        first: Camera,
        second: Camera,
        second_from_first: Isometry3<f64>,
        matches: Vec<Match>,
    ) -> Vec<f64>;

    /// The score of a motion, which is better when it is smaller: the sum of the squared errors of
    /// all matches, each of them counted as at most the gate.
    fn score(squared_errors: Vec<f64>, gate: f64) -> f64;
    // ANCHOR_END: judging

    // ANCHOR: refusing
    /// How many motions, of `tried` ones that have nothing to do with the matches, would on
    /// average have `agree` matches **or more** within the gate. Each of the `matches` is there with
    /// probability `chance`, independently of all others.
    fn false_alarms(agree: usize, matches: usize, chance: f64, tried: usize) -> f64;

    /// The place in `motions` of the one with the least score. `None` when that could be luck:
    /// when the number of false alarms, for as many matches as have a squared error of at most the
    /// gate and for as many motions as were tried, is more than `most_alarms`.
    fn chosen_motion(
        first: Camera,
        second: Camera,
        motions: Vec<Isometry3<f64>>,
        matches: Vec<Match>,
        gate: f64,
        chance: f64,
        most_alarms: f64,
    ) -> Option<usize>;
    // ANCHOR_END: refusing
}
