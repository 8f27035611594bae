//! Residuals from small to beyond a right angle, and intervals from short to long.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::residual_jacobian::{Case, dictionary, jacobian, moved, way};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let mut cases: Vec<Case> =
        (0..30).map(|_| Case::drawn(&mut draw, [0.2, 2.5], [0.1, 4.0])).collect();
    let large: Vec<Case> =
        (0..20).map(|_| Case::drawn(&mut draw, [1.5, 2.6], [0.5, 2.0])).collect();
    let states = large.clone();
    cases.extend(&large);
    let ways = cases.clone();
    let moves: Vec<(Case, f64, _)> =
        large.iter().map(|case| (*case, draw.uniform(-3.0..3.0), draw.vector(1.0..20.0))).collect();
    vec![
        Check::new("residual_anywhere", move |answer| {
            ways.iter().try_for_each(|case| way(answer, case))
        }),
        Check::new("jacobian_of_small_and_large_residuals", move |answer| {
            cases.iter().try_for_each(|case| jacobian(answer, case))
        }),
        Check::new("jacobian_of_a_window_turned_about_the_vertical", move |answer| {
            moves.iter().try_for_each(|(case, yaw, by)| moved(answer, case, *yaw, by))
        }),
        Check::new("dictionary_for_any_state", move |answer| {
            states.iter().try_for_each(|case| dictionary(answer, case))
        }),
    ]
}
