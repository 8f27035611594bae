//! More or fewer matches, fewer and more wrong ones, sharper pixels, and more motions to choose from.

use exercise_spec::answer::Transport;
use exercise_spec::check::{Check, Failure};
use exercise_spec::draw::Draw;
use exercise_spec::robust_motion::{
    Choice, Drawing, Pictures, Range, chosen, draws, errors, false_alarm, scores,
};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let ranges = [
        Range { matches: 40, wrong: 0.4, sigma: [0.3, 1.2], tried: 36, turn: 0.2 },
        Range { matches: 90, wrong: 0.5, sigma: [0.6, 2.5], tried: 15, turn: 0.4 },
    ];
    let drawings: Vec<Drawing> =
        (0..40).map(|index| Drawing::drawn(&mut draw, 30 + 4 * index)).collect();
    let pictures: Vec<Pictures> =
        (0..6).map(|index| Pictures::drawn(&mut draw, ranges[index % 2])).collect();
    let mut choices = |by_luck: bool| -> Vec<Choice> {
        (0..4).map(|index| Choice::drawn(&mut draw, ranges[index % 2], by_luck)).collect()
    };
    let (found, lucky) = (choices(false), choices(true));
    let mut any: Vec<Choice> = found.iter().chain(&lucky).cloned().collect();
    draw.shuffle(&mut any);
    vec![
        Check::new("draws_for_any_share_of_right_matches", move |answer| {
            drawings.iter().try_for_each(|case| draws(answer, case))
        }),
        Check::new("errors_of_any_motion", move |answer| {
            pictures.iter().try_for_each(|case| errors(answer, case))
        }),
        Check::new("scores_of_any_motion", over(found.clone(), scores)),
        Check::new("false_alarms_of_any_number", over(lucky, false_alarm)),
        Check::new("a_motion_or_none_in_any_order", over(any, chosen)),
    ]
}

type Asked = fn(&dyn Transport, &Choice) -> Result<(), Failure>;

fn over(
    cases: Vec<Choice>,
    check: Asked,
) -> impl Fn(&dyn Transport) -> Result<(), Failure> + Send + Sync + 'static {
    move |answer| cases.iter().try_for_each(|case| check(answer, case))
}
