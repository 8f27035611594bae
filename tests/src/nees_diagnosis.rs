//! Estimates that are turned farther, bands of fewer and of more runs, campaigns of other vehicles.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::nees_diagnosis::{Case, Flown, Tested, bounded, diagnosed, parts};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let cases: Vec<Case> = (0..30).map(|_| Case::drawn(&mut draw, [0.3, 3.0])).collect();
    let tested: Vec<Tested> =
        (0..30).map(|index| Tested::drawn(&mut draw, index % 3 == 0)).collect();
    let flown = Flown::all(&mut draw, 4);
    vec![
        Check::new("parts_of_any_estimate", move |answer| {
            cases.iter().try_for_each(|case| parts(answer, case))
        }),
        Check::new("bands_of_any_family", move |answer| {
            tested.iter().try_for_each(|tested| bounded(answer, tested))
        }),
        Check::new("faults_of_other_vehicles", move |answer| diagnosed(answer, &flown)),
    ]
}
