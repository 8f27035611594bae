//! Wrong answers to [`robust_motion`](crate::robust_motion).

use exercise_spec::robust_motion::*;
use nalgebra::{Isometry3, Matrix3, Vector3};
use vislam::manifold::so3;

use super::Wrong;
use crate::robust_motion as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    draws: right::draws,
    squared_errors: right::squared_errors,
    score: right::score,
    false_alarms: right::false_alarms,
    chosen_motion: right::chosen_motion,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let draws_are =
        |misconception, draws| Wrong::new(misconception, Functions { draws, ..REFERENCE });
    let errors_are = |misconception, squared_errors| {
        Wrong::new(misconception, Functions { squared_errors, ..REFERENCE })
    };
    let score_is =
        |misconception, score| Wrong::new(misconception, Functions { score, ..REFERENCE });
    let alarms_are = |misconception, false_alarms| {
        Wrong::new(misconception, Functions { false_alarms, ..REFERENCE })
    };
    let choice_is = |misconception, chosen_motion| {
        Wrong::new(misconception, Functions { chosen_motion, ..REFERENCE })
    };
    vec![
        draws_are(&WITH_REPETITION, |right, matches, sample, useful, confidence| {
            let share = right as f64 / matches as f64;
            number((1.0 - confidence).ln() / (1.0 - useful * share.powi(sample as i32)).ln())
        }),
        draws_are(&USEFUL_FORGOTTEN, |right, matches, sample, _, confidence| {
            right::draws(right, matches, sample, 1.0, confidence)
        }),
        draws_are(&USEFUL_AFTERWARDS, |right, matches, sample, useful, confidence| {
            let all = all_right(right, matches, sample);
            number((1.0 - confidence).ln() / (1.0 - all).ln() / useful)
        }),
        draws_are(&CONFIDENCE_EXCHANGED, |right, matches, sample, useful, confidence| {
            right::draws(right, matches, sample, useful, 1.0 - confidence)
        }),
        draws_are(&ROUNDED_DOWN, |right, matches, sample, useful, confidence| {
            right::draws(right, matches, sample, useful, confidence) - 1
        }),
        draws_are(&MEAN_WAIT, |right, matches, sample, useful, _| {
            number(1.0 / (useful * all_right(right, matches, sample)))
        }),
        errors_are(&ONE_PICTURE, |first, second, motion, matches| {
            errors(first, second, motion, &matches, |l| l.value.powi(2) / l.parts[1])
        }),
        errors_are(&DISTANCES_ADDED, |first, second, motion, matches| {
            errors(first, second, motion, &matches, |l| {
                l.value.powi(2) / l.parts[0] + l.value.powi(2) / l.parts[1]
            })
        }),
        errors_are(&ALGEBRAIC, |first, second, motion, matches| {
            errors(first, second, motion, &matches, |l| l.value.powi(2))
        }),
        errors_are(&NOISE_IGNORED, |first, second, motion, mut matches| {
            for seen in &mut matches {
                (seen.sigma_first, seen.sigma_second) = (1.0, 1.0);
            }
            right::squared_errors(first, second, motion, matches)
        }),
        errors_are(&DEVIATIONS_NOT_SQUARED, |first, second, motion, mut matches| {
            for seen in &mut matches {
                seen.sigma_first = seen.sigma_first.sqrt();
                seen.sigma_second = seen.sigma_second.sqrt();
            }
            right::squared_errors(first, second, motion, matches)
        }),
        errors_are(&DEVIATIONS_EXCHANGED, |first, second, motion, mut matches| {
            for seen in &mut matches {
                std::mem::swap(&mut seen.sigma_first, &mut seen.sigma_second);
            }
            right::squared_errors(first, second, motion, matches)
        }),
        errors_are(&NOT_SQUARED, |first, second, motion, matches| {
            let squares = right::squared_errors(first, second, motion, matches);
            squares.into_iter().map(f64::sqrt).collect()
        }),
        errors_are(&MOTION_INVERTED, |first, second, motion, matches| {
            right::squared_errors(first, second, motion.inverse(), matches)
        }),
        score_is(&INLIERS_COUNTED, |squares, gate| {
            squares.iter().filter(|square| **square <= gate).count() as f64
        }),
        score_is(&OUTLIERS_FREE, |squares, gate| {
            squares.iter().filter(|square| **square <= gate).sum()
        }),
        score_is(&UNTRUNCATED, |squares, _| squares.iter().sum()),
        alarms_are(&EXACTLY_SO_MANY, |agree, matches, chance, tried| {
            right::false_alarms(agree, matches, chance, tried)
                - right::false_alarms(agree + 1, matches, chance, tried)
        }),
        alarms_are(&MORE_THAN_SO_MANY, |agree, matches, chance, tried| {
            right::false_alarms(agree + 1, matches, chance, tried)
        }),
        alarms_are(&TRIED_ONCE, |agree, matches, chance, _| {
            right::false_alarms(agree, matches, chance, 1)
        }),
        alarms_are(&MEAN_COUNT, |_, matches, chance, _| matches as f64 * chance),
        choice_is(&MOST_INLIERS, |first, second, motions, matches, gate, _, _| {
            (0..motions.len()).max_by_key(|place| {
                let squares =
                    right::squared_errors(first, second, motions[*place], matches.clone());
                squares.iter().filter(|square| **square <= gate).count()
            })
        }),
        choice_is(&LEAST_SQUARES, |first, second, motions, matches, _, _, _| {
            right::chosen_motion(first, second, motions, matches, f64::MAX, 0.5, f64::MAX)
        }),
        choice_is(&NEVER_REFUSED, |first, second, motions, matches, gate, chance, _| {
            right::chosen_motion(first, second, motions, matches, gate, chance, f64::MAX)
        }),
        choice_is(&REFUSED_AT_ONCE, |_, _, _, _, _, _, _| None),
    ]
}

fn number(draws: f64) -> usize {
    draws.ceil() as usize
}

fn all_right(right: usize, matches: usize, sample: usize) -> f64 {
    (0..sample).map(|k| (right - k) as f64 / (matches - k) as f64).product()
}

/// The left side of the epipolar constraint, and the variance that each of the pixels gives it.
struct Linear {
    value: f64,
    parts: [f64; 2],
}

fn errors(
    first: Camera,
    second: Camera,
    motion: Isometry3<f64>,
    matches: &[Match],
    of: impl Fn(&Linear) -> f64,
) -> Vec<f64> {
    let essential =
        so3::hat(&motion.translation.vector) * motion.rotation.to_rotation_matrix().into_inner();
    let slopes = |camera: &Camera| {
        let Camera { fx, fy, cx, cy } = *camera;
        Matrix3::new(1.0 / fx, 0.0, -cx / fx, 0.0, 1.0 / fy, -cy / fy, 0.0, 0.0, 1.0)
    };
    let fundamental = slopes(&second).transpose() * essential * slopes(&first);
    let linear = |seen: &Match| {
        let (a, b) = (seen.first.push(1.0), seen.second.push(1.0));
        let part = |line: Vector3<f64>, sigma: f64| sigma * sigma * line.xy().norm_squared();
        let parts = [
            part(fundamental.transpose() * b, seen.sigma_first),
            part(fundamental * a, seen.sigma_second),
        ];
        Linear { value: b.dot(&(fundamental * a)), parts }
    };
    matches.iter().map(|seen| of(&linear(seen))).collect()
}
