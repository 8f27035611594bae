//! Longer windows, places farther away, estimates that are farther off and nearer by.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::first_estimates::{
    Claiming, Displaced, Equations, Kept, Range, Steps, Window, chosen, equations, free,
    least_change, which_is_lost,
};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let near = Range { poses: 4, landmarks: 3, within: 3.0, error: [0.03, 0.1], turn: [0.02, 0.1] };
    let far = Range { poses: 5, landmarks: 4, within: 40.0, error: [1.0, 4.0], turn: [0.2, 0.6] };
    let ranges = [near, far];
    let steps = [Steps::World, Steps::Body];
    let windows: Vec<(Window, Steps)> =
        (0..20).map(|k| (Window::drawn(&mut draw, &ranges[k / 10]), steps[k % 2])).collect();
    let linear: Vec<Equations> =
        (0..20).map(|k| Equations::drawn(&mut draw, &ranges[k / 10], steps[k % 2])).collect();
    let mut kept = |count: usize, disagree: bool| -> Vec<Kept> {
        (0..count)
            .map(|k| {
                let agree = !disagree || draw.index(0..2) == 0;
                Kept::drawn(&mut draw, &ranges[k % 2], agree)
            })
            .collect()
    };
    let (agreeing, any) = (kept(20, false), kept(30, true));
    let displaced: Vec<Displaced> =
        ranges.iter().flat_map(|range| Displaced::of_all_kinds(&mut draw, range)).collect();
    let claiming: Vec<Claiming> =
        (0..20).map(|k| Claiming::drawn(&mut draw, 2 + k % 5, 6 + k % 7)).collect();
    vec![
        Check::new("directions_of_larger_windows", move |answer| {
            windows.iter().try_for_each(|(window, steps)| free(answer, window, *steps))
        }),
        Check::new("derivatives_of_larger_windows", move |answer| {
            linear.iter().try_for_each(|linear| equations(answer, linear))
        }),
        Check::new("estimates_for_larger_windows", move |answer| {
            agreeing.iter().try_for_each(|kept| chosen(answer, kept))
        }),
        Check::new("disagreement_in_larger_windows", move |answer| {
            any.iter().try_for_each(|kept| chosen(answer, kept))
        }),
        Check::new("directions_lost_near_and_far", move |answer| {
            displaced.iter().try_for_each(|displaced| which_is_lost(answer, displaced))
        }),
        Check::new("least_changes_of_any_rows", move |answer| {
            claiming.iter().try_for_each(|claiming| least_change(answer, claiming))
        }),
    ]
}
