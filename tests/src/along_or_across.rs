//! Pairs as narrow as a stereo camera's and as wide as a walk, points from near to far, and one to
//! four cameras.

use exercise_spec::along_or_across::{
    Case, across, along, exact, least_noticed, predicted, worked,
};
use exercise_spec::check::Check;
use exercise_spec::draw::Draw;

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let mut some = |depth: [f64; 2], spread: f64| -> Vec<Case> {
        (0..30).map(|index| Case::drawn(&mut draw, 1 + index % 4, depth, spread)).collect()
    };
    let (rays, sides) = (some([0.7, 40.0], 0.3), some([0.7, 40.0], 0.3));
    let (slopes, moves) = (some([0.7, 40.0], 0.3), some([0.7, 40.0], 0.3));
    let (wide, narrow, shared) =
        (some([1.0, 20.0], 0.35), some([1.0, 20.0], 0.05), some([1.0, 20.0], 0.0));
    let pairs: Vec<Case> =
        some([1.0, 20.0], 0.3).into_iter().filter(|case| case.views.len() == 2).collect();
    vec![
        Check::new("along_any_ray", move |answer| {
            rays.iter().try_for_each(|case| along(answer, case))
        }),
        Check::new("across_any_ray", move |answer| {
            sides.iter().try_for_each(|case| across(answer, case))
        }),
        Check::new("first_order_anywhere", move |answer| {
            slopes.iter().try_for_each(|case| predicted(answer, case))
        }),
        Check::new("exact_anywhere", move |answer| {
            moves.iter().try_for_each(|case| exact(answer, case))
        }),
        Check::new("least_noticed_wide", move |answer| {
            wide.iter().try_for_each(|case| least_noticed(answer, case))
        }),
        Check::new("least_noticed_narrow", move |answer| {
            narrow.iter().try_for_each(|case| least_noticed(answer, case))
        }),
        Check::new("least_noticed_in_one_place", move |answer| {
            shared.iter().try_for_each(|case| least_noticed(answer, case))
        }),
        Check::new("readings_of_a_pair", move |answer| {
            pairs.iter().try_for_each(|case| worked(answer, case, 0.05))
        }),
    ]
}
