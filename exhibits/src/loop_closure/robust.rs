//! Switches and weights of loops.

use vislam::loop_closure::truncated_weight;

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Switch = |xi, square| [xi / (xi + square), 0.5 * xi * square / (xi + square)];
    let mutants: [(_, Switch); 4] = [
        ("the other way", |xi, square| [square / (xi + square), 0.5 * xi * square / (xi + square)]),
        ("the error not squared", |xi, square| {
            [xi / (xi + square.sqrt()), 0.5 * xi * square / (xi + square)]
        }),
        ("the prior not counted", |xi, square| {
            let switch = xi / (xi + square);
            [switch, 0.5 * switch * switch * square]
        }),
        ("the loop not counted", |xi, square| {
            let switch = xi / (xi + square);
            [switch, 0.5 * xi * (1.0 - switch).powi(2)]
        }),
    ];
    chapter.equation("switch-value", switch_value, formula, &mutants);

    let mutants: [(_, Weight); 4] = [
        ("cut at the threshold", |error, limit, _| f64::from(u8::from(error < limit))),
        ("the control parameter not taken off", |error, limit, control| {
            truncated_weight(error, limit, control) + between(error, limit, control)
        }),
        ("errors not squared", |error, limit, control| {
            truncated_weight(error.sqrt(), limit.sqrt(), control)
        }),
        ("the control parameter inverted", |error, limit, control| {
            truncated_weight(error, limit, 1.0 / control)
        }),
    ];
    chapter.equation("graduated-weight", graduated_weight, truncated_weight, &mutants);
}

/// The control parameter where the weight is neither one nor zero.
fn between(error: f64, limit: f64, control: f64) -> f64 {
    let weight = truncated_weight(error, limit, control);
    if weight > 0.0 && weight < 1.0 { control } else { 0.0 }
}

/// Where a function of a number between zero and one is least, and its value there: by thirds.
fn least(function: impl Fn(f64) -> f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if function(left) < function(right) { high = right } else { low = left }
    }
    let middle = 0.5 * (low + high);
    [middle, function(middle)]
}

/// The best switch and the cost with it, by its information and the squared error of its loop.
type Switch = fn(f64, f64) -> [f64; 2];

fn switch_value(formula: Switch) -> Comparison {
    let against = "a search for the switch";
    Comparison::absolute(against, 1e-6, "").over(STATES, 96, |random| {
        let (xi, square) = (random.logarithmic(1.0..30.0), random.logarithmic(0.01..1e3));
        let cost = |switch: f64| 0.5 * (switch * switch * square + xi * (1.0 - switch).powi(2));
        (formula(xi, square), least(cost))
    })
}

/// A weight, by the squared error, the squared threshold and the control parameter.
type Weight = fn(f64, f64, f64) -> f64;

fn graduated_weight(formula: Weight) -> Comparison {
    let against = "a search for the weight";
    Comparison::absolute(against, 1e-6, "").over(STATES, 97, |random| {
        let (error, limit) = (random.logarithmic(0.1..100.0), random.logarithmic(1.0..20.0));
        let control = random.logarithmic(0.05..20.0);
        let cost =
            |weight: f64| weight * error + control * (1.0 - weight) / (control + weight) * limit;
        (formula(error, limit, control), least(cost)[0])
    })
}
