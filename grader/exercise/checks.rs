//! What is asked about an answer, and on which instances.

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::check::{Check, Failure, compare_number};
use crate::draw::Draw;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "{name}",
    title: "{title}",
    chapter: "{chapter}",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &[],
    forbidden: &[],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    NEGATED, "negated":
        "TODO: what the output shows, and a question that leads on without the answer.";
}

/// An instance. TODO: what a check needs, and nothing that an answer would give.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// TODO: what it is, and its unit.
    pub number: f64,
}

impl Case {
    /// A case within bounds, which the hidden checks draw wider.
    pub fn drawn(draw: &mut Draw, greatest: f64) -> Self {
        Self { number: draw.uniform(0.1 * greatest..greatest) }
    }

    /// What is right. TODO: find it in a way that is no answer, by differences or by brute force.
    fn oracle(&self) -> f64 {
        self.number + self.number
    }
}

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(1);
    (0..20).map(|_| Case::drawn(&mut draw, 10.0)).collect()
}

// TODO: each check states something that an answer must do; its name is that statement.
fn checks() -> Vec<Check> {
    vec![Check::new("the_number_is_doubled", |answer| {
        cases().iter().try_for_each(|case| doubled(answer, case))
    })]
}

/// The number against the oracle.
///
/// # Errors
///
/// A failure, which names the mistake where it is known.
pub fn doubled(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let expected = case.oracle();
    compare_number("the number", Answer(answer).doubled(&case.number)?, expected)
        .or_number(&NEGATED, -expected)
        .judge()
        .map_err(|failure| failure.given(&[("number", &case.number)]))
}
