//! What each part of the estimator is worth: flights on which much is wrong, with one part after the other left out.

use nalgebra::Vector3;
use vislam::filtering::BlockNees;
use vislam::inertial::{ImuBias, LONGEST_STEP, NavState};
use vislam::least_squares::Kernel;
use vislam::msckf::Start;
use vislam::odometry::{Estimator, OdometryOptions};
use vislam::simulation::{Flight, FlightRecording};

use crate::chapter::Chapter;
use crate::msckf::flights::example::{flight, start};
use crate::msckf::flights::flown;
use crate::record::{RecordValue, accepted};
use crate::smoother::followed::{Followed, options};

const SEEDS: u64 = 20;
const SECONDS: f64 = 30.0;
/// What is wrong with the flights: the share of wrong pixels, the delay of the camera's clock in seconds, and biases in
/// rad/s and m/s².
const OUTLIERS: f64 = 0.02;
const LATE: f64 = 0.01;
const BIAS: [f64; 2] = [0.01, 0.1];
/// What is known of the delay and of each bias, as standard deviations.
const LATE_SIGMA: f64 = 0.02;
/// By how much the densities of the readings are told wrong.
const TOLD: f64 = 10.0;
/// What is as good as known.
const KNOWN: f64 = 1e-6;

/// A part that is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    /// Nothing is left out.
    Whole,
    /// Every pixel counts as it is: no kernel and no gate.
    Robust,
    /// The camera's clock is taken for the sensor's.
    TimeOffset,
    /// Biases are taken for zero.
    Biases,
    /// Readings are taken for ten times as noisy as they are.
    Noisier,
    /// Readings are taken for ten times as exact as they are.
    Surer,
    /// The tilt of the start is taken for exact.
    Tilt,
    /// Variables that the prior names are linearized where they are.
    Frozen,
}

impl Switch {
    pub const ALL: [Self; 8] = [
        Self::Whole,
        Self::Robust,
        Self::TimeOffset,
        Self::Biases,
        Self::Noisier,
        Self::Surer,
        Self::Tilt,
        Self::Frozen,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::Robust => "robust",
            Self::TimeOffset => "offset",
            Self::Biases => "biases",
            Self::Noisier => "noisier",
            Self::Surer => "surer",
            Self::Tilt => "tilt",
            Self::Frozen => "frozen",
        }
    }

    /// Leaves it out.
    fn off(self, options: &mut OdometryOptions, start: &mut Start) {
        let scaled = |options: &mut OdometryOptions, factor: f64| {
            for noise in [&mut options.smoother.sensors.noise, &mut options.msckf.noise] {
                noise.gyro *= factor;
                noise.accelerometer *= factor;
            }
        };
        match self {
            Self::Whole => {}
            Self::Robust => {
                (options.smoother.kernel, options.smoother.gate) = (Kernel::Squared, f64::INFINITY);
                options.msckf.gate = 1.0;
            }
            Self::TimeOffset => {
                options.smoother.sensors.calibrated.time_offset = None;
                options.msckf.calibrated.time_offset = None;
            }
            Self::Biases => {
                start.bias = ImuBias::default();
                known(start, 9..15);
                for noise in [&mut options.smoother.sensors.noise, &mut options.msckf.noise] {
                    (noise.gyro_walk, noise.accelerometer_walk) = (KNOWN, KNOWN);
                }
            }
            Self::Noisier => scaled(options, TOLD),
            Self::Surer => scaled(options, 1.0 / TOLD),
            Self::Tilt => known(start, 0..2),
            Self::Frozen => options.smoother.frozen = false,
        }
    }
}

/// Lets some coordinates of a start be as good as known where they are believed to be.
fn known(start: &mut Start, which: std::ops::Range<usize>) {
    for at in which {
        start.covariance.row_mut(at).fill(0.0);
        start.covariance.column_mut(at).fill(0.0);
        start.covariance[(at, at)] = KNOWN * KNOWN;
    }
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("flight", format!("that of examples/filter.rs, {SECONDS} s")),
        ("wrong", format!("{OUTLIERS} of the pixels, clock {LATE} s late, biases {BIAS:?}")),
        ("told", format!("densities by {TOLD}")),
    ];
    chapter.record("odometry_switches", inputs, switched);
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("switch_outliers", 100.0 * OUTLIERS, "%", 0);
    chapter.number("switch_late", 1e3 * LATE, "ms", 0);
    chapter.number("switch_gyro", 1e3 * BIAS[0], "mrad/s", 0);
    chapter.number("switch_accelerometer", BIAS[1], "m/s²", 1);
    chapter.number("switch_seconds", SECONDS, "s", 0);
    chapter.number("switch_told", TOLD, "", 0);
    let plain = options(&flown(&flight(1.0), 0), Estimator::Smoother);
    chapter.number("waiting_seconds", 3.0 * (plain.begin.longest() + 0.5), "s", 1);
    chapter.number("patience", plain.patience, "s", 0);
    chapter.number("longest_gap", LONGEST_STEP, "s", 1);
    let of = |switch: Switch| {
        accepted("odometry_switches", &format!("smoother_{}_rmse", switch.name()))
            / accepted("odometry_switches", "smoother_whole_rmse")
    };
    chapter.number("times_offset", of(Switch::TimeOffset), "", 1);
    chapter.number("times_tilt", of(Switch::Tilt), "", 0);
}

/// A flight with all that, and a start that knows the biases as well as a stand does.
fn hard(seed: u64) -> (FlightRecording, Start) {
    let easy = flight(SECONDS);
    let mut rig = easy.rig;
    rig.time_offset = LATE;
    let initial_bias = ImuBias {
        gyro: Vector3::new(BIAS[0], -BIAS[0], BIAS[0]),
        accelerometer: Vector3::new(-BIAS[1], BIAS[1], BIAS[1]),
    };
    let mut recording = flown(&Flight { rig, initial_bias, outliers: OUTLIERS, ..easy }, seed);
    // By a clock that is believed to be late enough, the last picture is later than all readings.
    recording.pictures.pop();
    let mut start = start(&recording, seed);
    start.rig.time_offset = 0.0;
    (recording, start)
}

/// What is not told of a flight: its camera's clock.
fn told(recording: &FlightRecording, estimator: Estimator) -> OdometryOptions {
    let mut told = recording.clone();
    told.flight.rig.time_offset = 0.0;
    let mut options = options(&told, estimator);
    for calibrated in [&mut options.smoother.sensors.calibrated, &mut options.msckf.calibrated] {
        calibrated.time_offset = Some(LATE_SIGMA);
    }
    options
}

/// The root of the mean square of position errors, and the normalized errors of position and yaw at the end.
fn judged(recording: &FlightRecording, followed: &Followed) -> [f64; 3] {
    let truth = |nanoseconds: i64| -> NavState {
        recording.flight.motion.at(1e-9 * nanoseconds as f64).state
    };
    let squares = followed.causal.iter().map(|(_, estimate)| {
        (estimate.state.position - truth(estimate.nanoseconds).position).norm_squared()
    });
    let rmse = (squares.sum::<f64>() / followed.causal.len() as f64).sqrt();
    let (_, last) = followed.causal.last().expect("there are pictures");
    let covariance = last.covariance.fixed_view::<9, 9>(0, 0).into_owned();
    let nees = BlockNees::of(&last.state, &truth(last.nanoseconds), &covariance);
    let nees = nees.expect("a covariance");
    [rmse, nees.position, nees.yaw]
}

/// A flight with something switched off.
fn followed(
    seed: u64,
    (switch, estimator): (Switch, Estimator),
    patience: Option<f64>,
) -> Option<(FlightRecording, Followed)> {
    let (recording, mut start) = hard(seed);
    let mut options = told(&recording, estimator);
    options.patience = patience.unwrap_or(options.patience);
    switch.off(&mut options, &mut start);
    let followed = Followed::simulated(&recording, options, &start).ok()?;
    (followed.losses == 0).then_some((recording, followed))
}

/// How many flights are said to be lost by an odometry with the patience that it usually has.
fn said(of: (Switch, Estimator)) -> usize {
    (0..SEEDS).filter(|seed| followed(*seed, of, None).is_none()).count()
}

fn switched() -> Vec<RecordValue> {
    let mut values = vec![RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0)];
    for switch in Switch::ALL {
        for estimator in [Estimator::Smoother, Estimator::Msckf] {
            if switch == Switch::Frozen && estimator == Estimator::Msckf {
                continue;
            }
            let followed = (0..SEEDS).filter_map(|seed| {
                let whole = followed(seed, (switch, estimator), Some(f64::INFINITY));
                whole.map(|(recording, followed)| judged(&recording, &followed))
            });
            let followed: Vec<[f64; 3]> = followed.collect();
            let mean = |of: fn(&[f64; 3]) -> f64| {
                followed.iter().map(of).sum::<f64>() / followed.len() as f64
            };
            let name = |what: &str| format!("{estimator}_{}_{what}", switch.name());
            let mut push = |what: &str, value, unit, decimals| {
                values.push(RecordValue::new(name(what), value, unit, decimals, 0.02));
            };
            push("lost", (SEEDS as usize - followed.len()) as f64, "", 0);
            if matches!(switch, Switch::TimeOffset | Switch::Biases) {
                push("said", said((switch, estimator)) as f64, "", 0);
            }
            if followed.is_empty() {
                continue;
            }
            push("rmse", 100.0 * mean(|[rmse, ..]| rmse * rmse).sqrt(), "cm", 1);
            push("position", mean(|[_, position, _]| *position), "", 1);
            push("yaw", mean(|[_, _, yaw]| *yaw), "", 1);
        }
    }
    values
}
