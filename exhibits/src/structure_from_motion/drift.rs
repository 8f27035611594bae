//! How a chain of turns with errors drifts.

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Drift); 3] = [
        ("errors of places, not of headings", |steps, turn, length| {
            turn * turn * length * length * steps
        }),
        ("each heading with its own error alone", |steps, turn, length| {
            turn * turn * length * length * steps * (steps + 1.0) / 2.0
        }),
        ("one error throughout", |steps, turn, length| (turn * length * steps).powi(2)),
    ];
    chapter.equation("chain-drift", chain_drift, drift, &mutants);
}

/// Steps, the standard deviation of each turn and the length of a step: the variance across the way at its end.
type Drift = fn(f64, f64, f64) -> f64;

fn drift(steps: f64, turn: f64, length: f64) -> f64 {
    turn * turn * length * length * steps * (steps + 1.0) * (2.0 * steps + 1.0) / 6.0
}

fn chain_drift(formula: Drift) -> Comparison {
    let against = "the mean square over ten thousand walks";
    Comparison::relative(against, 0.08).over(STATES / 4, 21, |random| {
        let steps = random.uniform(3.0..30.0) as usize;
        let (turn, length) = (random.logarithmic(1e-4..1e-3), random.uniform(0.5..2.0));
        let walks = 10_000;
        let sum: f64 = (0..walks).map(|_| walk(steps, turn, length, random).powi(2)).sum();
        (formula(steps as f64, turn, length), sum / walks as f64)
    })
}

/// Where a walk ends, across its direction.
fn walk(steps: usize, turn: f64, length: f64, random: &mut Random) -> f64 {
    let (mut heading, mut across) = (0.0, 0.0);
    for _ in 0..steps {
        heading += random.normal(turn);
        across += length * f64::sin(heading);
    }
    across
}
