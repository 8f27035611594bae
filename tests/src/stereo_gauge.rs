//! Baselines from that of a telephone to that of a car, three to five rigs, more points and fewer.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::stereo_gauge::{
    Case, blocks, counts, eigenvalues, motions, reduced, second_camera,
};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let mut some = |count: usize, baseline: [f64; 2]| -> Vec<Case> {
        let counts = |index: usize| [3 + index % 3, 7 + 2 * (index % 3)];
        (0..count).map(|index| Case::drawn(&mut draw, counts(index), baseline)).collect()
    };
    let (poses, pixels) = (some(10, [0.02, 1.2]), some(10, [0.02, 1.2]));
    let (wide, units) = (some(6, [0.05, 1.0]), some(4, [0.05, 1.0]));
    let (narrow, moves) = (some(6, [0.02, 0.1]), some(10, [0.1, 0.2]));
    vec![
        Check::new("right_camera_at_any_distance", move |answer| {
            poses.iter().try_for_each(|case| second_camera(answer, case))
        }),
        Check::new("right_blocks_at_any_distance", move |answer| {
            pixels.iter().try_for_each(|case| blocks(answer, case))
        }),
        Check::new("reduced_system_of_any_rigs", move |answer| {
            wide.iter().try_for_each(|case| reduced(answer, case))
        }),
        Check::new("stiffnesses_of_any_rigs", move |answer| {
            units.iter().try_for_each(|case| eigenvalues(answer, case))
        }),
        Check::new("free_directions_with_a_short_baseline", move |answer| {
            narrow.iter().try_for_each(|case| counts(answer, case))
        }),
        Check::new("motions_of_any_rigs", move |answer| {
            moves.iter().try_for_each(|case| motions(answer, case))
        }),
    ]
}
