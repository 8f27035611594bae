//! Larger windows farther from the origin, longer intervals, and other motions of each kind, in short and long intervals.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::scale_and_gravity::{Flights, Pair, Window, larger, split, verdicts};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let windows: Vec<(Window, f64)> = (0..15)
        .map(|count| {
            let factor = draw.uniform(1.1..5.0);
            let scale = if count % 2 == 0 { factor } else { 1.0 / factor };
            (Window::drawn(&mut draw, 2 + count / 2, 3 + count, [1.0, 80.0]), scale)
        })
        .collect();
    let pairs: Vec<Pair> = (0..30).map(|_| Pair::drawn(&mut draw, [0.1, 4.0])).collect();
    let flights: Vec<Flights> = [[0.4, 0.7], [1.6, 2.5], [0.3, 0.6], [1.5, 2.0]]
        .map(|duration| Flights::drawn(&mut draw, duration))
        .into();
    vec![
        Check::new("windows_anywhere", move |answer| {
            windows.iter().try_for_each(|(window, scale)| larger(answer, window, *scale))
        }),
        Check::new("two_parts_of_any_residual", move |answer| {
            pairs.iter().try_for_each(|pair| split(answer, pair))
        }),
        Check::new("verdicts_on_other_motions", move |answer| {
            flights.iter().try_for_each(|flights| verdicts(answer, flights))
        }),
    ]
}
