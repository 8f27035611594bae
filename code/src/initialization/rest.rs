//! A body at rest: how it is noticed, and what can be known of it then.

use nalgebra::{Matrix3, Rotation3, Vector3};
use thiserror::Error;

use super::Sensors;
use crate::datasets::tracks::Picture;
use crate::inertial::{ImuBias, NavState, StampedSample, WindowError, between};
use crate::manifold::so3;
use crate::msckf::Start;
use crate::preintegration::Matrix15;

// ANCHOR: rest_options
/// What is known of a body before it is watched, and how sharply it is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestOptions {
    /// The standard deviation of the accelerometer's bias on each axis, in m/s².
    pub accelerometer_bias: f64,
    /// How fast a body may still move that counts as standing, in m/s on each axis, as a standard
    /// deviation.
    pub velocity: f64,
    /// How fast it may turn, in rad/s on each axis.
    pub turning: f64,
    /// Pictures move when half of their features have gone farther than this many standard
    /// deviations of a pixel.
    pub motion: f64,
    /// The fewest features that both the first and the last picture must show.
    pub least_features: usize,
    /// How many standard deviations the mean force may be off gravity in length.
    pub force: f64,
}

impl Default for RestOptions {
    fn default() -> Self {
        Self {
            accelerometer_bias: 0.1,
            velocity: 0.01,
            turning: 1e-3,
            motion: 3.0,
            least_features: 8,
            force: 5.0,
        }
    }
}
// ANCHOR_END: rest_options

// ANCHOR: at_rest
/// What is known at the end of a stand that pictures and readings show: gravity's direction as the
/// mean of the accelerometer has it, and the gyroscope's bias. The heading and the position are
/// zero by choice.
///
/// The covariance counts that tilt and accelerometer bias cannot be told apart: with û upwards in the
/// body, b the bias and n the noise of the mean, the body is turned by û × (b + n) / g. Implements
/// {eq:rest-tilt}.
///
/// # Errors
///
/// [`NotAtRest`] says what moves, or what is missing.
pub fn at_rest(
    sensors: &Sensors,
    readings: &[StampedSample],
    pictures: &[Picture],
    options: &RestOptions,
) -> Result<Start, NotAtRest> {
    if sensors.gravity.is_nan() || sensors.gravity <= 0.0 {
        return Err(NotAtRest::Weightless { gravity: sensors.gravity });
    }
    let (first, last) = pictures_at_rest(sensors, pictures, options)?;
    let [from, to] = [first, last].map(|picture| sensors.rig.imu_nanoseconds(picture.nanoseconds));
    let between = between(readings, from, to)?;
    if between.iter().any(|reading| !reading.sample.is_finite()) {
        return Err(NotAtRest::Reading { nanoseconds: not_finite(readings, from) });
    }
    let means = Means::of(sensors, &between);
    let force = means.accelerometer.norm();
    let sigma = means.accelerometer_variance + options.accelerometer_bias.powi(2);
    let allowed = options.force * sigma.sqrt();
    let is_gravity = (force - sensors.gravity).abs() <= allowed;
    if !is_gravity {
        return Err(NotAtRest::Force { force, gravity: sensors.gravity, allowed });
    }
    Ok(means.start(sensors, to, options))
}
// ANCHOR_END: at_rest

/// The time of the first reading that is not finite, from the last one at `from` or before: it makes what
/// is interpolated beside it not finite either.
fn not_finite(readings: &[StampedSample], from: i64) -> i64 {
    let first = readings.partition_point(|reading| reading.nanoseconds <= from).saturating_sub(1);
    let broken = readings[first..].iter().find(|reading| !reading.sample.is_finite());
    broken.map_or(from, |reading| reading.nanoseconds)
}

/// The first and the last picture, if most features stand in them at one place.
// ANCHOR: pictures_at_rest
fn pictures_at_rest<'a>(
    sensors: &Sensors,
    pictures: &'a [Picture],
    options: &RestOptions,
) -> Result<(&'a Picture, &'a Picture), NotAtRest> {
    let none = NotAtRest::Features { found: 0, needed: options.least_features };
    let (first, last) = pictures.first().zip(pictures.last()).ok_or(none)?;
    let moved = first.features.iter().filter_map(|feature| {
        let found = last.features.binary_search_by_key(&feature.track, |other| other.track);
        Some((last.features[found.ok()?].pixel - feature.pixel).norm())
    });
    let mut moved: Vec<f64> = moved.collect();
    let (found, needed) = (moved.len(), options.least_features.max(1));
    if found < needed {
        return Err(NotAtRest::Features { found, needed });
    }
    let median = *moved.select_nth_unstable_by(found / 2, f64::total_cmp).1;
    if median <= options.motion * sensors.pixel_sigma {
        return Ok((first, last));
    }
    Err(NotAtRest::Motion { median: median / sensors.pixel_sigma, allowed: options.motion })
}
// ANCHOR_END: pictures_at_rest

/// Means of the readings of a stand, and their variances on each axis.
struct Means {
    gyro: Vector3<f64>,
    accelerometer: Vector3<f64>,
    gyro_variance: f64,
    accelerometer_variance: f64,
}

/// Into so many parts a stand is divided, to see how much their means scatter.
const PARTS: usize = 10;

impl Means {
    // ANCHOR: means
    /// The means of readings, and their variances: what the means of ten parts scatter, which
    /// counts shaking that lasts, or what the densities say, if that is more; and how far the bias
    /// at the end has walked from its mean.
    fn of(sensors: &Sensors, readings: &[StampedSample]) -> Self {
        let mean = |part: &[StampedSample], of: fn(&StampedSample) -> Vector3<f64>| {
            part.iter().map(of).sum::<Vector3<f64>>() / part.len() as f64
        };
        let noise = &sensors.noise;
        let seconds = readings[0].seconds_to(&readings[readings.len() - 1]);
        let variance = |of: fn(&StampedSample) -> Vector3<f64>, density: f64, walk: f64| {
            let (whole, size) = (mean(readings, of), readings.len().div_ceil(PARTS));
            let off = readings.chunks(size).map(|part| (mean(part, of) - whole).norm_squared());
            let (count, off) = off.fold((0.0, 0.0), |(n, sum), square| (n + 1.0, sum + square));
            let scatter = off / (3.0 * f64::max(count - 1.0, 1.0) * count);
            (whole, scatter.max(density * density / seconds) + walk * walk * seconds / 3.0)
        };
        let (gyro, gyro_variance) = variance(|r| r.sample.gyro, noise.gyro, noise.gyro_walk);
        let (accelerometer, accelerometer_variance) =
            variance(|r| r.sample.accelerometer, noise.accelerometer, noise.accelerometer_walk);
        Self { gyro, accelerometer, gyro_variance, accelerometer_variance }
    }
    // ANCHOR_END: means

    // ANCHOR: rest_start
    /// The state that these means say, and its covariance. Implements {eq:rest-vertical} and
    /// {eq:rest-covariance}.
    fn start(&self, sensors: &Sensors, nanoseconds: i64, options: &RestOptions) -> Start {
        let force = self.accelerometer.norm();
        let up = self.accelerometer / force;
        let (bias, noise) = (options.accelerometer_bias.powi(2), self.accelerometer_variance);
        let along = up * up.transpose();
        let across = Matrix3::identity() - along;
        let turned = so3::hat(&up) / sensors.gravity;
        let by_choice = GAUGE_SIGMA * GAUGE_SIGMA;
        let mut covariance = Matrix15::zeros();
        let mut put = |row, column, block: Matrix3<f64>| {
            covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
        };
        put(0, 0, (bias + noise) / sensors.gravity.powi(2) * across + by_choice * along);
        put(0, 12, bias * turned);
        put(12, 0, bias * turned.transpose());
        put(12, 12, bias * across + bias * noise / (bias + noise) * along);
        put(3, 3, Matrix3::from_diagonal_element(options.velocity.powi(2)));
        put(6, 6, Matrix3::from_diagonal_element(by_choice));
        let turning = self.gyro_variance + options.turning.powi(2);
        put(9, 9, Matrix3::from_diagonal_element(turning));
        let world_from_body = Rotation3::rotation_between(&up, &Vector3::z());
        let upside_down = || Rotation3::new(Vector3::x() * std::f64::consts::PI);
        let state = NavState {
            world_from_body: world_from_body.unwrap_or_else(upside_down),
            ..NavState::origin()
        };
        let seen = (force - sensors.gravity) * bias / (bias + noise);
        let bias = ImuBias { gyro: self.gyro, accelerometer: seen * up };
        Start { nanoseconds, state, bias, covariance, rig: sensors.rig }
    }
    // ANCHOR_END: rest_start
}

/// How well what is chosen is known, in radians and metres.
pub(super) const GAUGE_SIGMA: f64 = 1e-4;

/// Why a body does not count as standing still.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotAtRest {
    /// Too few features stand in the first and in the last picture.
    #[error(
        "{found} features stand in the first and in the last picture, and {needed} are needed to \
         see that nothing moves; give pictures with more of them, or a shorter stand"
    )]
    Features {
        /// How many do.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The pictures move.
    #[error(
        "half of the features have moved by {median:.1} standard deviations of a pixel or more, \
         and {allowed:.1} are allowed: the camera moves"
    )]
    Motion {
        /// The median of what they have moved, in standard deviations of a pixel.
        median: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// The mean force is not as large as gravity.
    #[error(
        "the mean force of {force:.2} m/s² differs from gravity's {gravity:.2} by more than \
         {allowed:.2}, which the bias may be: the body accelerates"
    )]
    Force {
        /// The length of the mean, in m/s².
        force: f64,
        /// Gravity's size, in m/s².
        gravity: f64,
        /// What is allowed, in m/s².
        allowed: f64,
    },
    /// The size of gravity is not positive.
    #[error(
        "gravity is {gravity} m/s²; give its size, which is positive, or begin in motion where there is none"
    )]
    Weightless {
        /// The size that was given, in m/s².
        gravity: f64,
    },
    /// A reading is none.
    #[error("the reading at {nanoseconds} ns has a number that is not finite; leave it out")]
    Reading {
        /// Its time, in nanoseconds.
        nanoseconds: i64,
    },
    /// The readings do not cover the pictures, have a gap, or are not in order.
    #[error(transparent)]
    Readings(#[from] WindowError),
}
