//! Long and short tracks, near and far landmarks, little parallax, and states no pixel depends on.

use exercise_spec::answer::Transport;
use exercise_spec::check::{Check, Failure};
use exercise_spec::draw::Draw;
use exercise_spec::null_space::{
    Case, Range, Tracks, corrected, information, landmark_gone, orthonormal, refusal, rotation,
};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let ranges = [
        Range { pictures: 5, depth: 20.0, baseline: 0.2, others: 15 },
        Range { pictures: 2, depth: 3.0, baseline: 0.5, others: 0 },
        Range { pictures: 12, depth: 50.0, baseline: 4.0, others: 3 },
        Range { pictures: 3, depth: 2.0, baseline: 0.6, others: 7 },
    ];
    let cases: Vec<Case> = ranges.iter().map(|range| Case::drawn(&mut draw, *range)).collect();
    let mut tracks = Vec::new();
    for (pictures, baseline) in [(2, 0.0), (3, 1e-13), (9, 0.0), (1, 0.4)] {
        let Range { depth, others, .. } = ranges[pictures % 4];
        let mut track = |baseline, pictures| {
            Case::drawn(&mut draw, Range { pictures, depth, baseline, others })
        };
        let (seen, unseen) = (track(1e-3 * depth, pictures.max(2)), track(baseline, pictures));
        tracks.push(Tracks::drawn(&mut draw, &seen, &unseen));
    }
    let mut numbers = || draw.uniform(-2.0..2.0) * 10.0_f64.powf(draw.uniform(-6.0..6.0));
    let columns: Vec<[f64; 2]> = (0..50).map(|_| [numbers(), numbers()]).collect();
    let each = |check: fn(&dyn Transport, &Case) -> Result<(), Failure>| {
        let cases = cases.clone();
        move |answer: &dyn Transport| cases.iter().try_for_each(|case| check(answer, case))
    };
    vec![
        Check::new("rotations_of_any_size", move |answer| {
            columns.iter().try_for_each(|pair| rotation(answer, *pair))
        }),
        Check::new("landmarks_anywhere", each(landmark_gone)),
        Check::new("orthonormal_rows_of_any_track", each(orthonormal)),
        Check::new("information_of_any_track", each(information)),
        Check::new("tracks_with_hardly_any_parallax_and_with_none", move |answer| {
            tracks.iter().try_for_each(|tracks| refusal(answer, tracks))
        }),
        Check::new("corrections_by_any_track", each(corrected)),
    ]
}
