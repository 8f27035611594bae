//! Intervals of a flight, preintegrated and compared with its ground truth.

use nalgebra::Vector3;
use vislam::datasets::euroc::GroundTruth;
use vislam::inertial::{ImuNoise, StampedSample, between};
use vislam::preintegration::{
    LONGEST_STEP, Preintegrated, Rule, Vector9, imu_residual, preintegrate_stamped,
};

use crate::preintegration::oracle::parts;

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

/// Root mean square residuals of attitude, velocity and position, each the length of a vector of
/// three, in radians, m/s and metres.
pub fn sizes(intervals: &[Interval], gravity: &Vector3<f64>) -> [f64; 3] {
    let residuals = || intervals.iter().map(|interval| parts(&interval.residual(gravity)));
    [0, 1, 2].map(|part| {
        let square: f64 = residuals().map(|residual| residual[part].norm_squared()).sum();
        (square / intervals.len() as f64).sqrt()
    })
}

impl Flight {
    /// From the first reading to the last.
    pub fn seconds(&self) -> f64 {
        self.samples[0].seconds_to(&self.samples[self.samples.len() - 1])
    }

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
    [0, 1, 2].map(|part| {
        let sum: f64 = intervals.iter().map(|i| 3.0 * i.sums.sigmas()[part].powi(2)).sum();
        (sum / intervals.len() as f64).sqrt()
    })
}

/// The mean of the normalized error squared.
pub fn normalized(intervals: &[Interval], gravity: &Vector3<f64>) -> f64 {
    let each = intervals.iter().map(|interval| {
        let whiten = interval.sums.sqrt_information().expect("more than one step");
        (whiten * interval.residual(gravity)).norm_squared()
    });
    each.sum::<f64>() / intervals.len() as f64
}
