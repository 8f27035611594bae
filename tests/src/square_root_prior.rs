//! Longer rows, windows of other sizes, more combinations that are known badly.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::square_root_prior::{Window, absorbed, measured, moved, precise, slid, windows};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let measured = measured(&mut draw, 30, [1, 12]);
    let windows = windows(&mut draw, 30);
    let stretched: Vec<Window> = [(6, 2), (9, 5), (12, 3), (15, 6)]
        .map(|(columns, gone)| Window::stretched(&mut draw, columns, gone, 1e4))
        .into();
    vec![
        Check::new("rows_of_any_length", move |answer| {
            measured.iter().try_for_each(|case| absorbed(answer, case))
        }),
        Check::new("slides_of_any_window", move |answer| {
            windows.iter().try_for_each(|window| slid(answer, window))
        }),
        Check::new("digits_of_what_is_known_least", move |answer| {
            stretched.iter().try_for_each(|window| precise(answer, window))
        }),
        Check::new("priors_seen_from_elsewhere", move |answer| {
            let mut draw = draw.clone();
            (1..15).try_for_each(|size| moved(answer, &mut draw, size))
        }),
    ]
}
