//! Steps that turn farther and last shorter or longer than the public ones, longer intervals,
//! other sensors.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::noise_growth::{
    Before, Interval, Points, Rest, Step, adds, carries, exponents, fit, whole,
};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let steps: Vec<Step> =
        (0..30).map(|_| Step::drawn(&mut draw, [0.2, 2.5], [0.05, 0.6])).collect();
    let known: Vec<Before> = steps.iter().map(|_| Before::drawn(&mut draw)).collect();
    let intervals: Vec<Interval> =
        (0..4).map(|count| Interval::drawn(&mut draw, 1 + 9 * count, [0.1, 1.5])).collect();
    let sensors: Vec<Rest> = (0..3).map(|_| Rest::drawn(&mut draw)).collect();
    let points: Vec<Points> =
        (0..20).map(|count| Points::drawn(&mut draw, 3 + count / 2)).collect();
    let again = steps.clone();
    vec![
        Check::new("steps_of_any_turn", move |answer| {
            steps.iter().try_for_each(|step| carries(answer, step))
        }),
        Check::new("noise_of_a_step", move |answer| {
            again.iter().zip(&known).try_for_each(|(step, known)| adds(answer, step, known))
        }),
        Check::new("covariance_of_short_and_long_intervals", move |answer| {
            intervals.iter().try_for_each(|interval| whole(answer, interval))
        }),
        Check::new("exponents_of_other_sensors", move |answer| {
            sensors.iter().try_for_each(|rest| exponents(answer, rest))
        }),
        Check::new("fit_of_many_points", move |answer| {
            points.iter().try_for_each(|points| fit(answer, points))
        }),
    ]
}
