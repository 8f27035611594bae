//! Intervals of a flight, preintegrated and compared with its ground truth.

use nalgebra::Vector3;
use vislam::datasets::euroc::GroundTruth;
use vislam::inertial::{ImuNoise, StampedSample, between};
use vislam::preintegration::{
    LONGEST_STEP, Preintegrated, Rule, Vector9, imu_residual, preintegrate_stamped,
};

/// Lengths of the intervals, in seconds.
pub const LENGTHS: [f64; 4] = [0.1, 0.5, 1.0, 2.0];

/// Half a millisecond: how far a length may be off because of where states lie.
const SLACK: i64 = 500_000;

/// Readings and states, on one clock.
pub struct Flight {
    pub samples: Vec<StampedSample>,
    pub truth: Vec<GroundTruth>,
}

/// Readings between two states of the ground truth, summed up at the bias of the first.
pub struct Interval {
    pub first: GroundTruth,
    pub last: GroundTruth,
    pub sums: Preintegrated,
}

impl Interval {
    pub fn residual(&self, gravity: &Vector3<f64>) -> Vector9 {
        imu_residual(&self.sums, &self.first.state, &self.last.state, gravity, &self.first.bias)
    }
}

/// Root mean squares of attitude, velocity and position, each the length of a vector of three, in
/// radians, m/s and metres.
pub fn sizes(residuals: impl Iterator<Item = Vector9>) -> [f64; 3] {
    let (mut squares, mut count) = ([0.0; 3], 0.0);
    for residual in residuals {
        for (part, square) in squares.iter_mut().enumerate() {
            *square += residual.fixed_rows::<3>(3 * part).norm_squared();
        }
        count += 1.0;
    }
    squares.map(|square| (square / count).sqrt())
}

impl Flight {
    /// Intervals of this length, one after the other. The ground truth's times are moved by
    /// `offset` seconds on the sensor's clock before the readings are looked up.
    pub fn intervals(&self, rule: Rule, seconds: f64, offset: f64) -> Vec<Interval> {
        let length = (1e9 * seconds).round() as i64;
        let offset = (1e9 * offset).round() as i64;
        let (mut intervals, mut at) = (Vec::new(), 0);
        while let Some(first) = self.truth.get(at) {
            let end = first.nanoseconds + length;
            let next = self.truth.partition_point(|state| state.nanoseconds < end - SLACK);
            let last = self.truth.get(next).filter(|state| state.nanoseconds <= end + SLACK);
            at = if last.is_some() { next } else { at + 1 };
            let Some(last) = last else { continue };
            let window =
                between(&self.samples, first.nanoseconds + offset, last.nanoseconds + offset);
            let sums = window.map(|window| {
                let (bias, noise) = (&first.bias, &ImuNoise::euroc());
                preintegrate_stamped(&window, rule, LONGEST_STEP, bias, noise)
            });
            if let Ok(Ok(sums)) = sums {
                intervals.push(Interval { first: *first, last: *last, sums });
            }
        }
        intervals
    }
}

/// The same root mean squares as the covariances of the sums predict them.
pub fn predicted(intervals: &[Interval]) -> [f64; 3] {
    let variance = |part: usize| {
        let sum: f64 = intervals.iter().map(|i| 3.0 * i.sums.sigmas()[part].powi(2)).sum();
        (sum / intervals.len() as f64).sqrt()
    };
    [variance(0), variance(1), variance(2)]
}

/// The mean of the normalized error squared.
pub fn normalized(intervals: &[Interval], gravity: &Vector3<f64>) -> f64 {
    let each = intervals.iter().map(|interval| {
        let whiten = interval.sums.sqrt_information().expect("more than one step");
        (whiten * interval.residual(gravity)).norm_squared()
    });
    each.sum::<f64>() / intervals.len() as f64
}
