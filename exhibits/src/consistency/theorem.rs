//! One linearization point for each variable: what it keeps, and what each condition is for.

use nalgebra::{SVector, Vector2, Vector3};
use vislam::consistency::{Chart, Claimed};
use vislam::inertial::NavState;
use vislam::least_squares::Manifold;

use super::draws::{self, Eye, SIGMA};
use super::small::{Case, LANDMARKS, Points};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::random::Random;

const STATES: usize = 100;
const FLIGHTS: usize = 20;
/// Rounding leaves less than this of what rows would say if nothing cancelled.
const ROUNDING: f64 = 1e-9;
/// By how much derivatives are taken elsewhere about the vertical, in rad.
const TURN: f64 = 0.4;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Gained = |eye, (state, point), (other, other_point)| {
        let up = Vector3::z();
        let turned = other.world_from_body * state.world_from_body.inverse() * up;
        let arm = point - state.position;
        let other_arm = other_point - other.position;
        eye.rows(other, other_point).1 * (up.cross(&arm) - turned.cross(&other_arm))
    };
    let mutants: [(_, Gained); 4] = [
        ("both turned alike", |eye, (state, point), (other, other_point)| {
            let arms = (point - state.position) - (other_point - other.position);
            eye.rows(other, other_point).1 * Vector3::z().cross(&arms)
        }),
        ("rotations exchanged", |eye, (state, point), (other, other_point)| {
            let up = Vector3::z();
            let turned = state.world_from_body * other.world_from_body.inverse() * up;
            let (arm, other_arm) = (point - state.position, other_point - other.position);
            eye.rows(other, other_point).1 * (up.cross(&arm) - turned.cross(&other_arm))
        }),
        ("the landmark's alone", |eye, (_, point), (other, other_point)| {
            eye.rows(other, other_point).1 * Vector3::z().cross(&(point - other_point))
        }),
        ("arms from the world's origin", |eye, (state, point), (other, other_point)| {
            let turned = other.world_from_body * state.world_from_body.inverse() * Vector3::z();
            eye.rows(other, other_point).1 * (Vector3::z().cross(point) - turned.cross(other_point))
        }),
    ];
    chapter.equation("yaw-gained", yaw_gained, formula, &mutants);

    let first = Case { chart: Chart::Separate, points: Points::First, known: false };
    let latest = Case { points: Points::Latest, ..first };
    let moved = |apart, turn| Case { points: Points::Moved { apart, turn }, ..first };
    for (condition, kept, dropped) in [
        ("symmetric", first, Case { known: true, ..first }),
        ("one-point", moved(false, TURN), latest),
        ("shift", moved(true, 0.0), moved(true, TURN)),
        (
            "constant",
            Case { chart: Chart::RightInvariant, ..latest },
            Case { chart: Chart::RightInvariantPoses, ..latest },
        ),
    ] {
        chapter.counterexample("one-point", condition, nothing_gained, [kept, dropped]);
    }
    let alone = Case { chart: Chart::RightInvariantPoses, ..latest };
    let [x, y, z, turn] = sum(latest).gained.map(f64::sqrt);
    chapter.number("small_landmarks", LANDMARKS as f64, "", 0);
    let shift = (x.max(y).max(z) / turn).max(1e-16);
    chapter.number("mixed_shift_exponent", shift.log10().ceil(), "", 0);
    chapter.number("alone_part", 100.0 * sum(alone).gained[3].sqrt() / turn, "%", 0);
}

/// A camera, a state and a landmark at which directions are taken, and the same elsewhere, where
/// the derivatives are.
type Gained = fn(&Eye, (&NavState, &Vector3<f64>), (&NavState, &Vector3<f64>)) -> Vector2<f64>;

fn yaw_gained(formula: Gained) -> Comparison {
    let against = "central differences of the pixel along the other estimate's turn";
    Comparison::relative(against, 1e-5).over(STATES, 7, |random| {
        let (eye, other) = (Eye::any(random), draws::state(random));
        let other_point = eye.ahead(&other, random);
        let off: [f64; 9] = std::array::from_fn(|_| random.normal(0.2));
        let state = other.retract(&off);
        let point = other_point + random.direction(0.3);
        let (free, of_point) = (draws::free(&state), draws::free_of_point(&point));
        let oracle = differences(1e-4, |along: SVector<f64, 1>| {
            let step = free.column(3) * along[0];
            let seen = other.retract(step.as_slice());
            eye.seen(&seen, &(other_point + of_point.column(3) * along[0])) / SIGMA
        });
        (formula(&eye, (&state, &point), (&other, &other_point)), oracle)
    })
}

/// What rows claimed along the four directions, over what they would claim if nothing cancelled.
fn nothing_gained(case: Case) -> Comparison {
    let against = "nothing gained in two pictures and the readings between them";
    Comparison::absolute(against, ROUNDING, "of the whole").over(FLIGHTS, 8, |random| {
        let Claimed { gained, whole } = case.flown(2, random).claimed;
        let share: [f64; 4] = std::array::from_fn(|at| gained[at] / whole[at]);
        (share, [0.0; 4])
    })
}

/// What the rows of many such filters claim.
fn sum(case: Case) -> Claimed {
    let (mut random, mut sum) = (Random::new(11), Claimed::default());
    (0..FLIGHTS).for_each(|_| sum.add(&case.flown(2, &mut random).claimed));
    sum
}
