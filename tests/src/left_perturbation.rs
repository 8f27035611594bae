//! Cameras farther away and turned farther than the public ones, with points from near to far.

use exercise_spec::check::{Check, each};
use exercise_spec::draw::Draw;
use exercise_spec::left_perturbation::{
    Case, adjoint, differences, forward, left_jacobian, third_column,
};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let cases: Vec<Case> =
        (0..50).map(|_| Case::drawn(&mut draw, [0.8, 30.0], 3.0, 15.0)).collect();
    let depths: Vec<f64> = (0..10).map(|_| draw.uniform(0.5..50.0)).collect();
    let near: Vec<Case> = (0..20).map(|_| Case::drawn(&mut draw, [1.5, 4.0], 2.0, 3.0)).collect();
    let (far, seen) = (cases.clone(), cases.clone());
    vec![
        Check::new("left_jacobian_anywhere", move |answer| {
            each(&cases, |case| left_jacobian(answer, case))
        }),
        Check::new("third_column_at_any_depth", move |answer| {
            depths.iter().try_for_each(|depth| third_column(answer, &Case::on_axis(*depth)))
        }),
        Check::new("adjoint_far_from_the_origin", move |answer| {
            far.iter().try_for_each(|case| adjoint(answer, case))
        }),
        Check::new("order_of_differences", move |answer| {
            near.iter().try_for_each(|case| differences(answer, case))
        }),
        Check::new("forward_motion_anywhere", move |answer| {
            seen.iter().try_for_each(|case| forward(answer, case))
        }),
    ]
}
