//! More or fewer matches, sharper and blurred ones, cameras turned farther, thresholds of all kinds.

use exercise_spec::answer::Transport;
use exercise_spec::check::{Check, Failure};
use exercise_spec::draw::Draw;
use exercise_spec::outlier_rescue::{Case, Range, pose, rescue, rmse, step, weights};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let ranges = [
        Range {
            matches: 40,
            depth: [1.0, 20.0],
            sigma: [0.2, 1.5],
            off: 40.0,
            threshold: [0.8, 1.5],
            angle: 3.0,
        },
        Range {
            matches: 150,
            depth: [3.0, 6.0],
            sigma: [0.8, 3.5],
            off: 30.0,
            threshold: [1.5, 2.5],
            angle: 2.0,
        },
    ];
    let cases: Vec<Case> = (0..6).map(|index| Case::drawn(&mut draw, ranges[index % 2])).collect();
    let each = |check: fn(&dyn Transport, &Case) -> Result<(), Failure>| {
        let cases = cases.clone();
        move |answer: &dyn Transport| cases.iter().try_for_each(|case| check(answer, case))
    };
    vec![
        Check::new("weights_of_any_noise", each(weights)),
        Check::new("steps_from_any_pose", each(step)),
        Check::new("poses_of_least_robust_cost", each(pose)),
        Check::new("rmse_of_any_matches", each(rmse)),
        Check::new("rescues_of_any_size", each(rescue)),
    ]
}
