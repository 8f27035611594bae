//! TODO: in what these instances differ from the public ones.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::{name}::{Case, doubled};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let cases: Vec<Case> = (0..50).map(|_| Case::drawn(&mut draw, 1000.0)).collect();
    vec![Check::new("any_number_is_doubled", move |answer| {
        cases.iter().try_for_each(|case| doubled(answer, case))
    })]
}
