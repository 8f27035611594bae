//! What an optimizer pays for one interval: the readings again, or one factor.

use std::hint::black_box;

use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::preintegration::{Preintegrated, imu_residual, linearize, preintegrate};
use vislam::simulation::Trajectory;

use crate::chapter::Chapter;
use crate::preintegration::speed::timed;
use crate::record::{RecordValue, accepted};

/// Readings in an interval.
pub const READINGS: [usize; 6] = [20, 50, 100, 200, 500, 1000];
/// Seconds between two readings.
const DT: f64 = 0.005;
/// The fastest of so many turns counts; in each, this many readings are gone through by each way.
const TURNS: usize = 40;
const READINGS_IN_A_TURN: usize = 40_000;
/// Evaluations of a factor that are timed together.
const EVALUATIONS: usize = 2000;

/// An interval of the figure-eight, its factor and two states.
struct Interval {
    samples: Vec<ImuSample>,
    sums: Preintegrated,
    first: NavState,
    second: NavState,
}

impl Interval {
    fn of(readings: usize) -> Self {
        let motion = Trajectory::figure_eight();
        let samples = motion.samples(&GRAVITY, DT, readings);
        let sums = preintegrate(&samples, DT, &ImuBias::default(), &ImuNoise::mems())
            .expect("the readings are finite");
        let (first, second) = (motion.at(0.0).state, motion.at(DT * readings as f64).state);
        Self { samples, sums, first, second }
    }

    /// The second state from the first and all readings.
    fn walked(&self) -> NavState {
        self.samples.iter().fold(self.first, |state, sample| state.propagate(sample, &GRAVITY, DT))
    }

    /// Microseconds of the state alone, of residual and Jacobians from the readings, and of the same
    /// from the factor.
    fn times(&self) -> [f64; 3] {
        let times = READINGS_IN_A_TURN / self.samples.len();
        let bias = ImuBias::default();
        let of_factor =
            |sums: &Preintegrated| linearize(sums, &self.first, &self.second, &GRAVITY, &bias);
        let state = timed(times, |_| {
            black_box(black_box(self).walked());
        });
        let again = timed(times, |_| {
            let samples = &black_box(self).samples;
            let sums = preintegrate(samples, DT, &bias, &ImuNoise::mems());
            black_box(sums.map(|sums| of_factor(&sums)).ok());
        });
        let factor = timed(EVALUATIONS, |_| {
            black_box(of_factor(&black_box(self).sums));
        });
        [state, again, factor].map(|seconds| 1e6 * seconds)
    }
}

/// The fastest times for each number of readings. The intervals take turns, so that whatever else the
/// machine does meets all of them.
fn measured() -> [[f64; 3]; READINGS.len()] {
    let intervals = READINGS.map(Interval::of);
    let mut fastest = [[f64::INFINITY; 3]; READINGS.len()];
    for _ in 0..TURNS {
        for (interval, fastest) in intervals.iter().zip(&mut fastest) {
            for (fastest, time) in fastest.iter_mut().zip(interval.times()) {
                *fastest = fastest.min(time);
            }
        }
    }
    fastest
}

const NAMES: [[&str; 3]; READINGS.len()] = [
    ["state_20", "sums_20", "factor_20"],
    ["state_50", "sums_50", "factor_50"],
    ["state_100", "sums_100", "factor_100"],
    ["state_200", "sums_200", "factor_200"],
    ["state_500", "sums_500", "factor_500"],
    ["state_1000", "sums_1000", "factor_1000"],
];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("motion", "Trajectory::figure_eight() at 200 Hz".to_owned()),
        ("readings", READINGS.map(|n| n.to_string()).join(" ")),
        ("turns", TURNS.to_string()),
        ("readings in a turn", READINGS_IN_A_TURN.to_string()),
    ];
    chapter.record("preintegration_cost", inputs, cost);
}

/// Registers what can be counted.
pub fn numbers(chapter: &mut Chapter) {
    let (rate, interval) = (1.0 / DT, 1.0);
    let readings = rate * interval;
    let (window, iterations) = (10.0, 8.0);
    let evaluations = window * iterations;
    chapter.number("rate", rate, "Hz", 0);
    chapter.number("readings", readings, "", 0);
    chapter.number("unknowns_per_second", 9.0 * rate, "", 0);
    chapter.number("unknowns_per_minute", 60.0 * 9.0 * rate, "", 0);
    chapter.number("window", window, "", 0);
    chapter.number("iterations", iterations, "", 0);
    chapter.number("evaluations", evaluations, "", 0);
    chapter.number("touched", evaluations * readings, "", 0);
    chapter.number("factor_bytes", size_of::<Preintegrated>() as f64, "", 0);
    chapter.number("reading_bytes", size_of::<ImuSample>() as f64, "", 0);
    chapter.number("readings_bytes", readings * size_of::<ImuSample>() as f64, "", 0);

    let live = Interval::of(200);
    let reached = live.walked();
    let residual = imu_residual(&live.sums, &live.first, &reached, &GRAVITY, &ImuBias::default());
    let digits = -residual.amax().max(1e-16).log10();
    chapter.number("agreed_digits", digits.floor(), "", 0);
}

fn cost() -> Vec<RecordValue> {
    let measured = measured();
    // Times are those of a machine and an hour.
    let value = |name, value, unit, decimals| RecordValue::new(name, value, unit, decimals, 3.0);
    let times = NAMES.as_flattened().iter().zip(measured.as_flattened());
    let mut values: Vec<RecordValue> = times
        .map(|(name, time)| value(*name, *time, "µs", if *time < 3.0 { 2 } else { 1 }))
        .collect();
    let last = READINGS.len() - 1;
    let per_reading = 1e3 * measured[last][1] / READINGS[last] as f64;
    values.push(value("per_reading", per_reading, "ns", 0));
    values.push(value("ratio_200", measured[3][1] / measured[3][2], "", 0));
    values
}

/// What the accepted record says, in microseconds.
pub fn recorded() -> [[f64; 3]; READINGS.len()] {
    NAMES.map(|names| names.map(|name| accepted("preintegration_cost", name)))
}
