//! How much of what the batch of everything so far knows is lost by a window and by a filter, and for how much time.

use nalgebra::{DMatrix, DVector};
use vislam::least_squares::Manifold;
use vislam::marginalization::{Block, Blocks, Information, divergence};
use vislam::odometry::{Estimate, Estimator, OdometryOptions};
use vislam::simulation::FlightRecording;

use super::followed::{Followed, options, rmse};
use crate::chapter::Chapter;
use crate::msckf::flights::example::{flight, start};
use crate::msckf::flights::flown;
use crate::record::{RecordValue, accepted};

const SEEDS: u64 = 20;
const SECONDS: f64 = 30.0;
/// From this picture on it is compared: the start is common to all.
const FROM: usize = 50;
/// Lags of the smoother, in tenths of a second.
pub const LAGS: [u32; 4] = [5, 10, 20, 40];
/// Poses of the filter's window.
pub const CLONES: [usize; 4] = [4, 8, 16, 32];
/// The lag and the window that are meant where nothing is said.
pub const PLAIN: [&str; 2] = ["smoother_20", "msckf_16"];

/// An estimator, and its name in the record.
fn contenders(recording: &FlightRecording) -> Vec<(String, OdometryOptions)> {
    let batch = ("batch".to_owned(), options(recording, Estimator::Batch));
    let smoothers = LAGS.map(|lag| {
        let mut options = options(recording, Estimator::Smoother);
        options.smoother.lag = 0.1 * f64::from(lag);
        (format!("smoother_{lag}"), options)
    });
    let filters = CLONES.map(|clones| {
        let mut options = options(recording, Estimator::Msckf);
        options.msckf.clones = clones;
        (format!("msckf_{clones}"), options)
    });
    [batch].into_iter().chain(smoothers).chain(filters).collect()
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("flight", format!("that of examples/filter.rs, {SECONDS} s")),
        ("lags", LAGS.map(|lag| lag.to_string()).join(" ")),
        ("clones", CLONES.map(|clones| clones.to_string()).join(" ")),
    ];
    chapter.record("smoother_divergence", inputs, divergences);
}

pub fn numbers(chapter: &mut Chapter) {
    let of = |name: &str, what: &str| accepted("smoother_divergence", &format!("{name}_{what}"));
    let [smoother, filter] = PLAIN;
    chapter.number("nats_smoother", of(smoother, "nats"), "", 2);
    chapter.number("nats_filter", of(filter, "nats"), "", 2);
    chapter.number("clones_short", CLONES[0] as f64, "", 0);
    chapter.number("clones_plain", CLONES[2] as f64, "", 0);
    chapter.number("clones_long", CLONES[3] as f64, "", 0);
    chapter.number("filter_by_batch", of(filter, "rmse") / of("batch", "rmse"), "", 2);
    chapter.number("time_ratio_filter", of(smoother, "time") / of(filter, "time"), "", 1);
    chapter.number("time_ratio_batch", of("batch", "time") / of(smoother, "time"), "", 0);
    let shortest = format!("smoother_{}", LAGS[0]);
    chapter.number("time_ratio_shortest", of("batch", "time") / of(&shortest, "time"), "", 1);
    chapter.number("time_ratio_plain", of(&shortest, "time") / of(filter, "time"), "", 1);
    chapter.number("divergence_seconds", SECONDS, "s", 0);
}

/// D(all‖some) of two estimates of one state, in nats.
fn nats(all: &Estimate, some: &Estimate) -> f64 {
    let blocks = || Blocks::new(vec![Block { name: 0, dimension: 15 }]).expect("a block");
    let mut off = [0.0; 15];
    all.state.local(&some.state, &mut off[..9]);
    all.bias.local(&some.bias, &mut off[9..]);
    let gaussian = |estimate: &Estimate, mean: DVector<f64>| {
        let information = estimate.covariance.try_inverse().expect("a covariance");
        let information = 0.5 * (information + information.transpose());
        let matrix = DMatrix::from_column_slice(15, 15, information.as_slice());
        let vector = &matrix * mean;
        Information::new(blocks(), matrix, vector).expect("it is symmetric")
    };
    let all = gaussian(all, DVector::zeros(15));
    divergence(&all, &gaussian(some, DVector::from_column_slice(&off))).expect("two Gaussians")
}

/// The sums over flights of what is told of one estimator.
#[derive(Default)]
struct Sums {
    nats: f64,
    squares: f64,
    seconds: f64,
    pictures: usize,
}

impl Sums {
    fn add(&mut self, recording: &FlightRecording, followed: &Followed, all: &Followed) {
        let count = (followed.causal.len() - FROM) as f64;
        let both = all.causal.iter().zip(&followed.causal).skip(FROM);
        self.nats += both.map(|((_, all), (_, some))| nats(all, some)).sum::<f64>() / count;
        let states = followed.causal.iter().map(|(at, estimate)| (*at, &estimate.state));
        self.squares += rmse(states, &recording.truth.states).powi(2);
        self.seconds += followed.seconds;
        self.pictures += followed.pictures;
    }
}

fn divergences() -> Vec<RecordValue> {
    let mut sums: Vec<(String, Sums)> = Vec::new();
    for seed in 0..SEEDS {
        let recording = flown(&flight(SECONDS), seed);
        let start = start(&recording, seed);
        let follow = |options| {
            Followed::simulated(&recording, options, &start).expect("the flight is followed")
        };
        let all = follow(options(&recording, Estimator::Batch));
        for (at, (name, options)) in contenders(&recording).into_iter().enumerate() {
            if sums.len() <= at {
                sums.push((name, Sums::default()));
            }
            sums[at].1.add(&recording, &follow(options), &all);
        }
    }
    let mut values = vec![RecordValue::new("seeds", SEEDS as f64, "", 0, 0.0)];
    for (name, sums) in &sums {
        let mut push = |what: &str, value, unit, within| {
            values.push(RecordValue::new(format!("{name}_{what}"), value, unit, 2, within));
        };
        if name != "batch" {
            push("nats", sums.nats / SEEDS as f64, "nats", 0.02);
        }
        push("rmse", 100.0 * (sums.squares / SEEDS as f64).sqrt(), "cm", 0.02);
        push("time", 1e3 * sums.seconds / sums.pictures as f64, "ms", 0.5);
    }
    values
}

/// A value of the accepted record.
pub fn recorded(name: &str, what: &str) -> f64 {
    accepted("smoother_divergence", &format!("{name}_{what}"))
}
