//! Four matches in ten are wrong: which of many motions to believe, or none.

use exercise_spec::robust_motion::{Camera, Match};
use nalgebra::{Isometry3, Matrix3};
use vislam::manifold::so3;

/// How many samples have to be drawn so that with probability `confidence`, or a larger one,
/// at least one of them gives a good motion. Each sample is drawn anew and consists of
/// `sample` **different** matches, of which `right` out of `matches` are right. A sample gives
/// a good motion when all of it is right **and** its noise is kind, which happens to a part
/// `useful` of the samples that are all right. There are `sample` right matches or more, some
/// are wrong, and `useful` and `confidence` lie between zero and one.
pub fn draws(right: usize, matches: usize, sample: usize, useful: f64, confidence: f64) -> usize {
    let all_right: f64 = (0..sample).map(|k| (right - k) as f64 / (matches - k) as f64).product();
    ((1.0 - confidence).ln() / (1.0 - useful * all_right).ln()).ceil() as usize
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
    let essential = so3::hat(&second_from_first.translation.vector)
        * second_from_first.rotation.to_rotation_matrix().into_inner();
    let fundamental = slopes(&second).transpose() * essential * slopes(&first);
    let square = |seen: &Match| {
        let (a, b) = (seen.first.push(1.0), seen.second.push(1.0));
        let (in_first, in_second) = (fundamental.transpose() * b, fundamental * a);
        let variance = seen.sigma_first.powi(2) * in_first.xy().norm_squared()
            + seen.sigma_second.powi(2) * in_second.xy().norm_squared();
        b.dot(&in_second).powi(2) / variance
    };
    matches.iter().map(square).collect()
}

/// Takes pixels with a one below to slopes with a one below.
fn slopes(camera: &Camera) -> Matrix3<f64> {
    let Camera { fx, fy, cx, cy } = *camera;
    Matrix3::new(1.0 / fx, 0.0, -cx / fx, 0.0, 1.0 / fy, -cy / fy, 0.0, 0.0, 1.0)
}

/// The score of a motion, which is better when it is smaller: the sum of the squared errors of
/// all matches, each of them counted as at most the gate.
pub fn score(squared_errors: Vec<f64>, gate: f64) -> f64 {
    squared_errors.iter().map(|square| square.min(gate)).sum()
}

/// How many motions, of `tried` ones that have nothing to do with the matches, would on
/// average have `agree` matches **or more** within the gate. Each of the `matches` is there with
/// probability `chance`, independently of all others.
pub fn false_alarms(agree: usize, matches: usize, chance: f64, tried: usize) -> f64 {
    let probability = |count: usize| {
        let ways: f64 = (0..count).map(|k| (matches - k) as f64 / (k + 1) as f64).product();
        ways * chance.powi(count as i32) * (1.0 - chance).powi((matches - count) as i32)
    };
    tried as f64 * (agree..=matches).map(probability).sum::<f64>()
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
    let errors: Vec<Vec<f64>> = motions
        .iter()
        .map(|motion| squared_errors(first, second, *motion, matches.clone()))
        .collect();
    let scores: Vec<f64> = errors.iter().map(|errors| score(errors.clone(), gate)).collect();
    let best = (0..motions.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b]))?;
    let agree = errors[best].iter().filter(|square| **square <= gate).count();
    let alarms = false_alarms(agree, matches.len(), chance, motions.len());
    (alarms <= most_alarms).then_some(best)
}
