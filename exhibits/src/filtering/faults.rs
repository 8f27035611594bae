//! Filters with a fault, and which statistic catches it at which flight length.

use std::sync::OnceLock;

use vislam::filtering::NeesBand;

use super::flown::{Filter, LANDMARKS, Moment, PICTURE_RATE, RIGHT, Sensor, flown, recorded};
use crate::chapter::Chapter;
use crate::record::{RecordValue, accepted};

pub const RUNS: usize = 50;
/// The lengths of the flights, in seconds, stated before they were flown.
pub const LENGTHS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];
/// Of each length: yaw, tilt, velocity, position, and innovations.
const STATISTICS: [&str; 5] = ["yaw", "tilt", "velocity", "position", "innovation"];
const DIMENSIONS: [usize; 4] = [1, 2, 3, 3];
/// How often a right filter may fail any of its tests.
pub const OUTSIDE: f64 = 0.05;

const DISPLACED: Filter = Filter { sensor: Sensor::Displacement, ..RIGHT };

/// The filters, with the word that their numbers begin with.
pub const FILTERS: [(&str, Filter); 7] = [
    ("map", RIGHT),
    ("pixels", Filter { noise: 2.0, ..RIGHT }),
    ("density", Filter { density: 0.25, ..RIGHT }),
    ("transition", Filter { coupled: false, ..RIGHT }),
    ("odometry", DISPLACED),
    ("uncoupled", Filter { coupled: false, ..DISPLACED }),
    ("untied", Filter { tied: false, ..DISPLACED }),
];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("runs", RUNS.to_string()),
        ("lengths", LENGTHS.map(|length| format!("{length} s")).join(", ")),
        ("flight", "figure-eight, ImuNoise::mems(), 10 pictures a second, 6 known landmarks".into()),
        ("faults", "pixels believed twice as noisy, densities a quarter, transition without the columns of the attitude, copies without their ties".into()),
    ];
    chapter.record("filter_faults", inputs, faults);
}

/// The moments of all runs of a filter at the stated lengths.
fn moments(filter: &Filter) -> Vec<[Moment; 4]> {
    let longest = LENGTHS[3];
    let run = |seed: u64| {
        let recording = recorded(longest, seed);
        let moments = flown(filter, &recording, seed);
        LENGTHS.map(|length| moments[(length * PICTURE_RATE).round() as usize - 1])
    };
    (0..RUNS as u64).map(run).collect()
}

/// For each length the means of the statistics, the root mean square of the position errors, in
/// centimetres, and how many numbers the innovations had.
fn summary(filter: &Filter) -> [([f64; 5], f64, f64); 4] {
    let runs = moments(filter);
    [0, 1, 2, 3].map(|length| {
        let at: Vec<Moment> = runs.iter().map(|run| run[length]).collect();
        let mean = |of: fn(&Moment) -> f64| at.iter().map(of).sum::<f64>() / RUNS as f64;
        let numbers: f64 = at.iter().map(|moment| moment.innovations[1]).sum();
        let squares: f64 = at.iter().map(|moment| moment.innovations[0]).sum();
        let statistics = [
            mean(|moment| moment.nees.yaw),
            mean(|moment| moment.nees.tilt),
            mean(|moment| moment.nees.velocity),
            mean(|moment| moment.nees.position),
            squares / numbers,
        ];
        let position = mean(|moment| moment.error.position.norm_squared()).sqrt();
        (statistics, 100.0 * position, numbers)
    })
}

fn faults() -> Vec<RecordValue> {
    let value = |name: String, value, decimals| RecordValue::new(name, value, "", decimals, 1e-3);
    let mut values = vec![value("runs".into(), RUNS as f64, 0)];
    for (word, filter) in &FILTERS {
        for (length, (statistics, position, numbers)) in summary(filter).into_iter().enumerate() {
            for (name, statistic) in STATISTICS.iter().zip(statistics) {
                let decimals = if statistic < 10.0 { 2 } else { 0 };
                values.push(value(format!("{word}_{name}_{length}"), statistic, decimals));
            }
            let rmse = format!("{word}_rmse_{length}");
            values.push(RecordValue::new(rmse, position, "cm", 1, 1e-3));
            assert_eq!(
                numbers,
                innovations(filter, length) as f64,
                "landmarks are always in sight"
            );
        }
    }
    values
}

/// How many numbers the innovations of all runs have until a length.
fn innovations(filter: &Filter, length: usize) -> usize {
    let of_a_picture = match filter.sensor {
        Sensor::Map => 2 * LANDMARKS,
        Sensor::Displacement => 3,
    };
    RUNS * of_a_picture * (LENGTHS[length] * PICTURE_RATE).round() as usize
}

/// A statistic as the record has it, and the ends of its band: one of the tests of all lengths.
pub struct Tested {
    pub value: f64,
    pub band: NeesBand,
}

impl Tested {
    /// Outside of the band: below it −1, above it 1.
    pub fn verdict(&self) -> i32 {
        i32::from(self.value > self.band.high) - i32::from(self.value < self.band.low)
    }
}

/// For each filter and length the five statistics.
pub fn tested() -> &'static [[[Tested; 5]; 4]; 7] {
    static TESTED: OnceLock<[[[Tested; 5]; 4]; 7]> = OnceLock::new();
    TESTED.get_or_init(|| {
        let share = OUTSIDE / (STATISTICS.len() * LENGTHS.len()) as f64;
        FILTERS.map(|(word, filter)| {
            [0, 1, 2, 3].map(|length| {
                [0, 1, 2, 3, 4].map(|statistic| {
                    let name = STATISTICS[statistic];
                    let of =
                        |name: &str| accepted("filter_faults", &format!("{word}_{name}_{length}"));
                    let (runs, dimension) = match DIMENSIONS.get(statistic) {
                        Some(dimension) => (RUNS, *dimension),
                        None => (innovations(&filter, length), 1),
                    };
                    let band = NeesBand::new(runs, dimension, share).expect("a probability");
                    Tested { value: of(name), band }
                })
            })
        })
    })
}

/// The root mean square of the position errors, in centimetres, as the record has it.
pub fn rmse(word: &str, length: usize) -> f64 {
    accepted("filter_faults", &format!("{word}_rmse_{length}"))
}
