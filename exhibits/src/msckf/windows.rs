//! How accurate the filter is for its time, by the length of its window.

use std::time::Instant;

use vislam::msckf::{MsckfOptions, WindowPolicy};

use super::flights::example::{flight, fly, start};
use super::flights::flown;
use crate::chapter::Chapter;
use crate::record::{RecordValue, accepted};

pub const WINDOWS: [usize; 6] = [6, 8, 11, 16, 24, 32];
pub const POLICIES: [(&str, WindowPolicy); 2] =
    [("oldest", WindowPolicy::Oldest), ("thin", WindowPolicy::Thin)];
const SEEDS: u64 = 10;
const SECONDS: f64 = 30.0;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("flight", format!("that of examples/filter.rs, {SECONDS} s")),
        ("windows", WINDOWS.map(|window| window.to_string()).join(" ")),
    ];
    chapter.record("msckf_windows", inputs, windows);
}

fn windows() -> Vec<RecordValue> {
    let mut sums = [[(0.0, f64::INFINITY); WINDOWS.len()]; POLICIES.len()];
    let mut pictures = 0;
    for seed in 0..SEEDS {
        let recording = flown(&flight(SECONDS), seed);
        let states = &recording.truth.states;
        pictures += states.len();
        for ((_, policy), sums) in POLICIES.iter().zip(&mut sums) {
            for (clones, (squares, fastest)) in WINDOWS.iter().zip(sums) {
                let options = MsckfOptions {
                    clones: *clones,
                    policy: *policy,
                    ..MsckfOptions::of_flight(&recording.flight)
                };
                let begin = Instant::now();
                fly(&recording, options, &start(&recording, seed), |number, filter, _| {
                    let off = states[number].position - filter.state().position;
                    *squares += off.norm_squared();
                })
                .expect("the flight is followed");
                let time = 1e3 * begin.elapsed().as_secs_f64() / states.len() as f64;
                *fastest = fastest.min(time);
            }
        }
    }
    let mut values = vec![
        RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0),
        RecordValue::new("seconds", SECONDS, "s", 0, 0.0),
    ];
    for ((name, _), sums) in POLICIES.iter().zip(&sums) {
        for (clones, (squares, fastest)) in WINDOWS.iter().zip(sums) {
            let rmse = 100.0 * (squares / pictures as f64).sqrt();
            values.push(RecordValue::new(format!("rmse_{name}_{clones}"), rmse, "cm", 2, 1e-2));
            values.push(RecordValue::new(format!("ms_{name}_{clones}"), *fastest, "ms", 2, 3.0));
        }
    }
    values
}

/// What the accepted record says of a policy: milliseconds a picture and the root mean square of the
/// errors in centimetres, by window.
pub fn recorded(policy: &str) -> [(f64, f64); WINDOWS.len()] {
    let of = |name: String| accepted("msckf_windows", &name);
    WINDOWS
        .map(|clones| (of(format!("ms_{policy}_{clones}")), of(format!("rmse_{policy}_{clones}"))))
}
