//! From two cameras to six, scenes near the origin of the world and far from it, factors from a tenth
//! to a hundredfold.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::scale_null_space::{Case, annihilated, direction, held, measured, rescaling};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let mut some = |count: usize, away: f64| -> Vec<Case> {
        let case = |index: usize| {
            let factor = draw.uniform(1.1..10.0).powi([-1, 1, 2][index % 3]);
            let case = Case::drawn(&mut draw, [2 + index % 5, 9 + index % 3], [3.0, 9.0], away);
            Case { factor, ..case }
        };
        (0..count).map(case).collect()
    };
    let (grows, near, far) = (some(20, 8.0), some(5, 1.0), some(5, 12.0));
    let (any, null, steps) = (some(5, 5.0), some(5, 5.0), some(8, 8.0));
    vec![
        Check::new("rescaled_by_any_factor", move |answer| {
            grows.iter().try_for_each(|case| rescaling(answer, case))
        }),
        Check::new("direction_near_the_origin", move |answer| {
            near.iter().try_for_each(|case| direction(answer, case))
        }),
        Check::new("direction_far_from_the_origin", move |answer| {
            far.iter().try_for_each(|case| direction(answer, case))
        }),
        Check::new("annihilation_of_any_direction", move |answer| {
            any.iter().try_for_each(|case| measured(answer, case))
        }),
        Check::new("scale_is_annihilated_anywhere", move |answer| {
            null.iter().try_for_each(|case| annihilated(answer, case))
        }),
        Check::new("distance_held_anywhere", move |answer| {
            steps.iter().try_for_each(|case| held(answer, case))
        }),
    ]
}
