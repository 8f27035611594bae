//! Other attitudes and sensors, motions in coarser and finer units, for longer and in more views.

use exercise_spec::align_gravity::{
    DETERMINED, Kind, Motion, Range, Stand, Turn, Twice, fits, found, leveled,
    motions_of_all_kinds, resting, second, verdicts,
};
use exercise_spec::check::Check;
use exercise_spec::draw::Draw;

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let ranges = [
        Range { views: 7, seconds: [1.2, 2.0], sigma: [0.001, 0.003], powers: [2.0, 4.0] },
        Range { views: 14, seconds: [2.5, 4.0], sigma: [0.003, 0.008], powers: [-4.0, -2.0] },
    ];
    let stands: Vec<Stand> = (0..40).map(|_| Stand::drawn(&mut draw)).collect();
    let turns = [Turn::Around, Turn::Tipped, Turn::Any, Turn::None];
    let twice: Vec<Twice> = (0..40).map(|k| Twice::drawn(&mut draw, turns[k % 4])).collect();
    let held: Vec<(Motion, f64)> = (0..8)
        .map(|k| {
            let motion = Motion::drawn(&mut draw, Kind::Lively, ranges[k % 2]);
            let scale = draw.uniform(0.6..1.6) * motion.scale;
            (motion, scale)
        })
        .collect();
    let free: Vec<Motion> = DETERMINED
        .iter()
        .enumerate()
        .map(|(k, kind)| Motion::drawn(&mut draw, *kind, ranges[k % 2]))
        .collect();
    let judged = ranges.map(|range| motions_of_all_kinds(&mut draw, range));
    let again = stands.clone();
    vec![
        Check::new("attitudes_of_any_stand", move |answer| {
            stands.iter().try_for_each(|stand| leveled(answer, stand))
        }),
        Check::new("tilt_and_bias_of_any_stand", move |answer| {
            again.iter().try_for_each(|stand| resting(answer, stand))
        }),
        Check::new("second_stands_after_any_turn", move |answer| {
            twice.iter().try_for_each(|twice| second(answer, twice))
        }),
        Check::new("velocity_and_gravity_in_any_unit", move |answer| {
            held.iter().try_for_each(|(motion, scale)| fits(answer, motion, *scale))
        }),
        Check::new("scales_of_motions_in_any_unit", move |answer| {
            free.iter().try_for_each(|motion| found(answer, motion))
        }),
        Check::new("refusals_in_any_unit", move |answer| {
            judged.iter().try_for_each(|motions| verdicts(answer, motions))
        }),
    ]
}
