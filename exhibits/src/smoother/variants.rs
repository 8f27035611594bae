//! The smoother with landmarks by another three numbers, with fewer pictures, and with a second camera, on the same flights.

use vislam::odometry::Estimator;
use vislam::simulation::{Flight, FlightRecording};
use vislam::smoother::{Keyframes, Parametrization, SmootherOptions};

use super::consistency::blocks;
use super::followed::{Followed, options, rmse};
use crate::chapter::Chapter;
use crate::msckf::flights::example::{flight, start};
use crate::msckf::flights::flown;
use crate::record::RecordValue;

const SEEDS: u64 = 20;
const SECONDS: f64 = 30.0;
/// How far to the right a second camera sits, in metres.
const BASELINE: f64 = 0.1;
/// By how much half of the tracks have to move for a picture to stay, in pixels, and after how long it does all the same.
const MOVED: f64 = 20.0;
const MOST_SECONDS: f64 = 0.5;

type Change = fn(&mut SmootherOptions, &FlightRecording);

const VARIANTS: [(&str, Change); 5] = [
    ("points", |_, _| {}),
    ("anchored", |options, _| options.landmarks = Parametrization::INVERSE_DEPTH),
    ("carried", |options, _| {
        options.landmarks = Parametrization::InverseDepth { largest_sigma: 0.05, is_carried: true };
    }),
    ("keyframes", |options, _| {
        options.keyframes = Keyframes::Moved { pixels: MOVED, most_seconds: MOST_SECONDS };
    }),
    ("pairs", |options, recording| options.right = recording.flight.right()),
];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        (
            "flight",
            format!("that of examples/filter.rs, {SECONDS} s, a second camera at {BASELINE} m"),
        ),
        ("keyframes", format!("{MOVED} px, {MOST_SECONDS} s")),
    ];
    chapter.record("smoother_variants", inputs, variants);
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("baseline", 100.0 * BASELINE, "cm", 0);
    chapter.number("keyframe_moved", MOVED, "px", 0);
    chapter.number("keyframe_seconds", MOST_SECONDS, "s", 1);
}

fn variants() -> Vec<RecordValue> {
    let mut sums = [[0.0; 3]; VARIANTS.len()];
    for seed in 0..SEEDS {
        let pair = Flight { baseline: Some(BASELINE), ..flight(SECONDS) };
        let recording = flown(&pair, seed);
        for ((_, change), sums) in VARIANTS.iter().zip(&mut sums) {
            let mut options = options(&recording, Estimator::Smoother);
            change(&mut options.smoother, &recording);
            let followed = Followed::simulated(&recording, options, &start(&recording, seed));
            let followed = followed.expect("the flight is followed");
            assert_eq!(followed.losses, 0, "no flight is lost");
            let states = followed.causal.iter().map(|(at, estimate)| (*at, &estimate.state));
            let (number, last) = followed.causal.last().expect("there are pictures");
            let own = [
                rmse(states, &recording.truth.states).powi(2),
                blocks(&recording, *number, last)[3],
                followed.seconds / followed.pictures as f64,
            ];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / SEEDS as f64);
        }
    }
    let mut values = vec![RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0)];
    let points = sums[0][2];
    for ((name, _), [squares, nees, seconds]) in VARIANTS.iter().zip(sums) {
        let mut push = |what: &str, value, unit, decimals, within| {
            values.push(RecordValue::new(format!("{name}_{what}"), value, unit, decimals, within));
        };
        push("rmse", 100.0 * f64::sqrt(squares), "cm", 2, 0.02);
        push("position", nees, "", 2, 0.02);
        push("time", seconds / points, "", 2, 0.5);
    }
    values
}
