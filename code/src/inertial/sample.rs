//! Readings of an inertial measurement unit.

use nalgebra::{Matrix6, Vector3, Vector6};
use thiserror::Error;

use crate::least_squares::Manifold;

// ANCHOR: sample
/// One reading, in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuSample {
    /// Angular velocity, in rad/s.
    pub gyro: Vector3<f64>,
    /// Specific force, acceleration less gravity, in m/s².
    pub accelerometer: Vector3<f64>,
}

/// What the sensors add to every reading, changing slowly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ImuBias {
    /// Of the gyroscope, in rad/s.
    pub gyro: Vector3<f64>,
    /// Of the accelerometer, in m/s².
    pub accelerometer: Vector3<f64>,
}
// ANCHOR_END: sample

impl ImuSample {
    // ANCHOR: corrected
    /// The reading less the bias, {eq:inertial-model} solved for what is felt.
    pub fn corrected(&self, bias: &ImuBias) -> Self {
        Self { gyro: self.gyro - bias.gyro, accelerometer: self.accelerometer - bias.accelerometer }
    }
    // ANCHOR_END: corrected

    /// The reading plus the bias, as a sensor with that bias gives it.
    pub fn biased(&self, bias: &ImuBias) -> Self {
        Self { gyro: self.gyro + bias.gyro, accelerometer: self.accelerometer + bias.accelerometer }
    }

    /// The reading halfway between two.
    pub fn mean(first: &Self, second: &Self) -> Self {
        Self {
            gyro: 0.5 * (first.gyro + second.gyro),
            accelerometer: 0.5 * (first.accelerometer + second.accelerometer),
        }
    }

    /// Whether all six numbers are finite.
    pub fn is_finite(&self) -> bool {
        // Zero times a number is zero, unless it is infinite or none.
        (0.0 * self.gyro + 0.0 * self.accelerometer).sum() == 0.0
    }
}

impl ImuBias {
    /// The bias as six numbers, gyroscope first.
    pub fn vector(&self) -> Vector6<f64> {
        let (g, a) = (&self.gyro, &self.accelerometer);
        Vector6::new(g.x, g.y, g.z, a.x, a.y, a.z)
    }

    /// The bias of six numbers, gyroscope first.
    pub fn from_vector(vector: &Vector6<f64>) -> Self {
        Self {
            gyro: vector.fixed_rows::<3>(0).into(),
            accelerometer: vector.fixed_rows::<3>(3).into(),
        }
    }

    /// Whether all six numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.vector().iter().all(|value| value.is_finite())
    }
}

/// Moved by addition, gyroscope first.
impl Manifold for ImuBias {
    fn dimension(&self) -> usize {
        6
    }

    fn retract(&self, step: &[f64]) -> Self {
        Self::from_vector(&self.vector().retract(step))
    }

    fn local(&self, to: &Self, step: &mut [f64]) {
        self.vector().local(&to.vector(), step);
    }

    fn local_jacobian(&self, _to: &Self, into: &mut [f64]) {
        into.copy_from_slice(Matrix6::<f64>::identity().as_slice());
    }
}

// ANCHOR: stamped
/// A reading and when it was taken, on the clock of the sensor. The clock counts in integers
/// because a time since 1970 in nanoseconds does not fit into the digits of an `f64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampedSample {
    /// Time, in nanoseconds.
    pub nanoseconds: i64,
    /// The reading.
    pub sample: ImuSample,
}
// ANCHOR_END: stamped

impl StampedSample {
    /// Seconds from this reading to another one, negative when that one is earlier.
    pub fn seconds_to(&self, later: &Self) -> f64 {
        seconds_between(self.nanoseconds, later.nanoseconds)
    }

    // ANCHOR: interpolate
    /// The reading at a time between two, on the straight line through them. Outside of them
    /// the line goes on; two readings at one time give the first.
    pub fn interpolate(first: &Self, second: &Self, nanoseconds: i64) -> Self {
        let whole = first.seconds_to(second);
        let part = seconds_between(first.nanoseconds, nanoseconds);
        let weight = if whole == 0.0 { 0.0 } else { part / whole };
        let (a, b) = (&first.sample, &second.sample);
        let sample = ImuSample {
            gyro: a.gyro + weight * (b.gyro - a.gyro),
            accelerometer: a.accelerometer + weight * (b.accelerometer - a.accelerometer),
        };
        Self { nanoseconds, sample }
    }
    // ANCHOR_END: interpolate
}

/// The difference as a float; times may lie at the ends of their range.
fn seconds_between(from: i64, to: i64) -> f64 {
    1e-9 * (i128::from(to) - i128::from(from)) as f64
}

/// Steps longer than this many seconds are taken for a gap in the readings.
pub const LONGEST_STEP: f64 = 0.1;

// ANCHOR: between
/// The readings from one time to another. The first and the last are interpolated where they do not
/// come then, and one in the middle where none lies between: one step has no inverse covariance.
///
/// # Errors
///
/// [`WindowError`] when times are not in order or not covered, or there is a gap. Of the readings
/// only those that are cut out are looked at: all have to be in order.
pub fn between(
    samples: &[StampedSample],
    start: i64,
    end: i64,
) -> Result<Vec<StampedSample>, WindowError> {
    if start >= end {
        return Err(WindowError::Order { start, end });
    }
    // The last reading that is not after the start, and the first that is not before the end.
    let first = samples.partition_point(|sample| sample.nanoseconds <= start);
    let last = samples.partition_point(|sample| sample.nanoseconds < end);
    if first == 0 || last == samples.len() {
        return Err(WindowError::NotCovered { start, end });
    }
    let mut window = samples[first - 1..=last.max(first - 1)].to_vec();
    cut(&mut window, start, end)?;
    Ok(window)
}
// ANCHOR_END: between

/// Moves the first reading to the start and the last one to the end, and adds one between them where there is
/// none.
fn cut(window: &mut Vec<StampedSample>, start: i64, end: i64) -> Result<(), WindowError> {
    for pair in window.windows(2) {
        let [from, to] = [pair[0].nanoseconds, pair[1].nanoseconds];
        if from >= to {
            return Err(WindowError::Unsorted { nanoseconds: to });
        }
        if pair[0].seconds_to(&pair[1]) > LONGEST_STEP {
            return Err(WindowError::Gap { from, to });
        }
    }
    let count = window.len();
    if count < 2 {
        return Err(WindowError::NotCovered { start, end });
    }
    let first = StampedSample::interpolate(&window[0], &window[1], start);
    let last = StampedSample::interpolate(&window[count - 2], &window[count - 1], end);
    (window[0], window[count - 1]) = (first, last);
    let middle = start.midpoint(end);
    if count == 2 && start < middle && middle < end {
        window.insert(1, StampedSample::interpolate(&first, &last, middle));
    }
    Ok(())
}

/// Why there are no readings for an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum WindowError {
    /// The interval is empty.
    #[error("the interval from {start} ns to {end} ns is empty; give an end after the start")]
    Order {
        /// Start given, in nanoseconds.
        start: i64,
        /// End given, in nanoseconds.
        end: i64,
    },
    /// There is no reading before the start or after the end.
    #[error(
        "the readings do not cover {start} ns to {end} ns; there must be one at or before the \
         start and one at or after the end"
    )]
    NotCovered {
        /// Start given, in nanoseconds.
        start: i64,
        /// End given, in nanoseconds.
        end: i64,
    },
    /// Nothing was measured in a part of the interval.
    #[error(
        "there is no reading between {from} ns and {to} ns; end before the gap, or begin after it"
    )]
    Gap {
        /// Time of the last reading before, in nanoseconds.
        from: i64,
        /// Time of the first reading after, in nanoseconds.
        to: i64,
    },
    /// Readings are not in the order of their times.
    #[error("the reading at {nanoseconds} ns is not later than the one before; sort them")]
    Unsorted {
        /// Time of the reading that is late, in nanoseconds.
        nanoseconds: i64,
    },
}
