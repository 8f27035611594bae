//! What waiting is worth, where everything can be computed by hand: a body that wanders along a line.

use nalgebra::DMatrix;

use crate::chapter::Chapter;
use crate::comparison::Comparison;

/// Random walks on which the formulas are compared.
const WALKS: usize = 50;
/// Measurements until the filter is in its steady state.
const STEADY: usize = 400;

/// By the variance of a step and of a measurement.
type Filtered = fn(f64, f64) -> f64;
/// By the filter's variance, the variance of a step and the steps of delay.
type Delayed = fn(f64, f64, usize) -> f64;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Filtered); 3] = [
        ("before the measurement", |q, r| 0.5 * (q + (q * q + 4.0 * q * r).sqrt())),
        ("half of the coupling", |q, r| 0.5 * (-q + (q * q + 2.0 * q * r).sqrt())),
        ("noises exchanged", |q, r| filtered(r, q)),
    ];
    chapter.equation("walk-filtered", walk_filtered, filtered, &mutants);
    let mutants: [(_, Delayed); 4] = [
        ("one power too few", |p, q, lag| {
            let gain = p / (p + q);
            p * (1.0 + gain.powi(2 * lag as i32)) / (1.0 + gain)
        }),
        ("as if nothing were left", |p, q, _| p / (1.0 + p / (p + q))),
        ("the filter's", |p, _, _| p),
        ("sign", |p, q, lag| {
            let gain = p / (p + q);
            p * (1.0 - gain.powi(2 * lag as i32 + 1)) / (1.0 - gain)
        }),
    ];
    chapter.equation("walk-delayed", walk_delayed, delayed, &mutants);
    let (step, noise) = (0.1_f64, 1.0_f64);
    let now = filtered(step * step, noise * noise);
    chapter.number("walk_step", step, "m", 1);
    chapter.number("walk_noise", noise, "m", 0);
    chapter.number("walk_now", 100.0 * now.sqrt(), "cm", 0);
    chapter.number("walk_gain", now / (now + step * step), "", 2);
    for (name, lag) in [("walk_after_5", 5), ("walk_after_20", 20)] {
        chapter.number(name, 100.0 * delayed(now, step * step, lag).sqrt(), "cm", 0);
    }
}

pub fn filtered(step: f64, noise: f64) -> f64 {
    0.5 * (-step + (step * step + 4.0 * step * noise).sqrt())
}

pub fn delayed(now: f64, step: f64, lag: usize) -> f64 {
    let gain = now / (now + step);
    now * (1.0 + gain.powi(2 * lag as i32 + 1)) / (1.0 + gain)
}

fn walk_filtered(formula: Filtered) -> Comparison {
    Comparison::relative("Kalman's recursion until it stands still", 1e-9).over(
        WALKS,
        3,
        |random| {
            let (step, noise) = (random.logarithmic(0.01..10.0), random.logarithmic(0.01..10.0));
            let mut variance = noise;
            for _ in 0..STEADY {
                variance = 1.0 / (1.0 / (variance + step) + 1.0 / noise);
            }
            (formula(step, noise), variance)
        },
    )
}

fn walk_delayed(formula: Delayed) -> Comparison {
    let against = "the inverse of the information of all steps and measurements";
    Comparison::relative(against, 1e-9).over(WALKS, 4, |random| {
        let (step, noise) = (random.logarithmic(0.05..10.0), random.logarithmic(0.05..10.0));
        let lag = random.uniform(0.0..8.0) as usize;
        let now = filtered(step, noise);
        // A chain that begins with what a filter knows, so that it is in its steady state.
        let count = lag + 1;
        let mut information = DMatrix::zeros(count, count);
        information[(0, 0)] = 1.0 / now;
        for at in 1..count {
            information[(at, at)] += 1.0 / noise + 1.0 / step;
            information[(at - 1, at - 1)] += 1.0 / step;
            information[(at - 1, at)] -= 1.0 / step;
            information[(at, at - 1)] -= 1.0 / step;
        }
        let all = information.try_inverse().map_or(f64::NAN, |covariance| covariance[(0, 0)]);
        (formula(now, step, lag), all)
    })
}
