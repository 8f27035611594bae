//! What a reading costs.

use std::hint::black_box;
use std::time::Instant;

use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample};
use vislam::preintegration::{Preintegrated, Preintegrator, Rule, correct_for_bias};
use vislam::simulation::Trajectory;

use super::oracle::summed_by;
use crate::chapter::Chapter;
use crate::record::RecordValue;
use crate::statistics;

/// Readings in a window, windows in a run, and runs of which the median counts.
const WINDOW: usize = 200;
const WINDOWS: usize = 50;
const RUNS: usize = 101;

pub fn exhibits(chapter: &mut Chapter) {
    chapter.number("integrator_bytes", size_of::<Preintegrator>() as f64, "bytes", 0);
    chapter.number("sums_bytes", size_of::<Preintegrated>() as f64, "bytes", 0);
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("motion", "Trajectory::figure_eight()".to_owned()),
        ("window", WINDOW.to_string()),
        ("windows", WINDOWS.to_string()),
        ("runs", RUNS.to_string()),
    ];
    chapter.record("preintegration_speed", inputs, speed);
}

fn window(samples: &[ImuSample], rule: Rule) -> Preintegrated {
    summed_by(rule, samples, std::iter::repeat(0.005), &ImuNoise::euroc())
}

/// The mean time of so many calls, in seconds.
pub fn timed(calls: usize, call: impl FnMut(usize)) -> f64 {
    let start = Instant::now();
    (0..calls).for_each(call);
    start.elapsed().as_secs_f64() / calls as f64
}

/// The median time of a call in nanoseconds, of runs of `calls` calls.
fn median(calls: usize, mut call: impl FnMut(usize)) -> f64 {
    statistics::median((0..RUNS).map(|_| 1e9 * timed(calls, &mut call)))
}

fn speed() -> Vec<RecordValue> {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, 0.005, WINDOW * WINDOWS + 1);
    let time = |rule| {
        let of_window = median(WINDOWS, |index| {
            black_box(window(&samples[WINDOW * index..=WINDOW * (index + 1)], rule));
        });
        of_window / WINDOW as f64
    };
    let (euler, midpoint) = (time(Rule::Euler), time(Rule::Midpoint));
    let sums = window(&samples[..=WINDOW], Rule::Midpoint);
    let bias = ImuBias::default();
    let corrected = median(1000, |_| {
        black_box(correct_for_bias(black_box(&sums), black_box(&bias)));
    });
    // Times are those of a machine and an hour.
    let value = |name, value, unit| RecordValue::new(name, value, unit, 0, 3.0);
    vec![
        value("window", WINDOW as f64, ""),
        value("euler", euler, "ns"),
        value("midpoint", midpoint, "ns"),
        value("again", 1e-3 * midpoint * WINDOW as f64, "µs"),
        value("corrected", corrected, "ns"),
    ]
}
