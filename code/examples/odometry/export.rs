//! What GTSAM was given and what it found, and the same batch solved here.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Instant;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector2, Vector3};
use serde::Deserialize;
use vislam::inertial::{ImuBias, ImuNoise, NavState};
use vislam::initialization::{Batch, Sensors};
use vislam::least_squares::{Kernel, Method, Options, Stop};
use vislam::preintegration::Rule;
use vislam::reprojection::Pinhole;

use super::estimate::Estimate;
use super::input::Input;

/// GTSAM stops where a step lowers the cost by less than this part of it, and so do we. Its start is
/// so near that steps need next to no damping.
const OPTIONS: Options = Options {
    method: Method::LevenbergMarquardt { initial_damping: 1e-9 },
    max_iterations: 60,
    gradient_tolerance: 1e-8,
    step_tolerance: 1e-8,
    decrease_tolerance: 1e-5,
};

/// A state's time may be off that of its picture by so much, in seconds: it has been rounded.
const ROUNDING: f64 = 1e-5;

/// The factors of a batch, where it starts and where GTSAM ends.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Export {
    /// Of the states, in seconds after the first reading.
    pub times: Vec<f64>,
    pub densities: Densities,
    /// The standard deviation of a normalized coordinate.
    pub sigma_normalized: f64,
    /// The threshold of Huber's kernel, in standard deviations.
    pub huber: f64,
    pub gravity: f64,
    pub prior: FirstState,
    pub start: Vec<State>,
    pub batch: Vec<State>,
    pub landmarks: BTreeMap<usize, Landmark>,
    pub cost: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Densities {
    gyro: f64,
    accelerometer: f64,
    gyro_walk: f64,
    accelerometer_walk: f64,
}

/// How well the first state is known beforehand.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct FirstState {
    pose_sigmas_rotation_then_position: [f64; 6],
    velocity_sigma: f64,
    bias_sigmas_accelerometer_then_gyroscope: [f64; 6],
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct State {
    world_from_body_wxyz: [f64; 4],
    position: [f64; 3],
    velocity: [f64; 3],
    bias_accelerometer: [f64; 3],
    bias_gyroscope: [f64; 3],
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Landmark {
    start: [f64; 3],
    /// The numbers of states, and where they saw it in normalized coordinates.
    seen: Vec<(usize, f64, f64)>,
}

/// Our solution beside GTSAM's.
pub struct Beside {
    pub estimate: Estimate,
    pub cost: f64,
    pub gtsam_cost: f64,
    /// The largest difference of a position along any direction, in our standard deviations along it.
    pub largest: f64,
    /// The root mean square of differences along three directions that are independent, in the same.
    pub root_mean_square: f64,
    pub iterations: usize,
    pub stop: Stop,
    /// Of solving alone.
    pub seconds: f64,
}

impl fmt::Display for Beside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "cost {:.4}  gtsam_cost {:.4}  largest_difference_sigma {:.4}  rms_difference_sigma {:.4}  \
             iterations {}  solve_seconds {:.4}  ({})",
            self.cost,
            self.gtsam_cost,
            self.largest,
            self.root_mean_square,
            self.iterations,
            self.seconds,
            self.stop
        )
    }
}

impl State {
    fn value(&self) -> (NavState, ImuBias) {
        let [w, x, y, z] = self.world_from_body_wxyz;
        let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        let state = NavState {
            world_from_body: turn.to_rotation_matrix(),
            velocity: self.velocity.into(),
            position: self.position.into(),
        };
        let (gyro, accelerometer) = (self.bias_gyroscope.into(), self.bias_accelerometer.into());
        (state, ImuBias { gyro, accelerometer })
    }
}

impl Export {
    pub fn read(text: &str) -> Result<Self, String> {
        let export: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let counts = [export.times.len(), export.start.len(), export.batch.len()];
        if counts.iter().any(|count| *count != counts[0]) {
            return Err(format!(
                "{} times, {} states of the start and {} of the batch; there must be as many of each",
                counts[0], counts[1], counts[2]
            ));
        }
        Ok(export)
    }

    /// Solves the batch of these factors from this start.
    pub fn solve(&self, input: &Input) -> Result<Beside, String> {
        let times = self.nanoseconds(input)?;
        let batch = self.batch(input, &times).map_err(|error| error.to_string())?;
        let start = Instant::now();
        let solution = batch.solve(&OPTIONS).map_err(|error| error.to_string())?;
        let seconds = start.elapsed().as_secs_f64();
        let covariance = batch.covariance(&solution.values).map_err(|error| error.to_string())?;
        let estimate = Estimate::of_batch(times, &batch, &solution.values, &covariance);
        let [largest, root_mean_square] = self.differences(&estimate);
        Ok(Beside {
            estimate,
            cost: solution.report.cost,
            gtsam_cost: self.cost,
            largest,
            root_mean_square,
            iterations: solution.report.iterations.len(),
            stop: solution.report.stop,
            seconds,
        })
    }

    /// Times of the states on the sensor's clock: those of the pictures that they belong to.
    fn nanoseconds(&self, input: &Input) -> Result<Vec<i64>, String> {
        let (rig, first) = (input.sensors.rig, input.readings[0].nanoseconds);
        let of_picture = |seconds: &f64| {
            let off = |time: &i64| (1e-9 * (time - first) as f64 - seconds).abs();
            let times = input.pictures.iter().map(|p| rig.imu_nanoseconds(p.nanoseconds));
            let nearest = times.min_by(|a, b| off(a).total_cmp(&off(b)));
            nearest.filter(|time| off(time) < ROUNDING).ok_or_else(|| {
                format!(
                    "there is no picture at {seconds} s after the first reading, where --start has a \
                     state; give the recording that it was made of"
                )
            })
        };
        self.times.iter().map(of_picture).collect()
    }

    fn batch(
        &self,
        input: &Input,
        times: &[i64],
    ) -> Result<Batch, vislam::initialization::BatchError> {
        let Densities { gyro, accelerometer, gyro_walk, accelerometer_walk } = self.densities;
        let sensors = Sensors {
            camera: Pinhole { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 },
            pixel_sigma: self.sigma_normalized,
            noise: ImuNoise { gyro, accelerometer, gyro_walk, accelerometer_walk },
            gravity: self.gravity,
            ..input.sensors
        };
        let guess: Vec<_> = self.start.iter().map(State::value).collect();
        let mut batch = Batch::by_rule(Rule::Euler, &sensors, &input.readings, times, &guess)?;
        let [a, b, c, x, y, z] = self.prior.pose_sigmas_rotation_then_position;
        let v = self.prior.velocity_sigma;
        let [ax, ay, az, gx, gy, gz] = self.prior.bias_sigmas_accelerometer_then_gyroscope;
        let first = (guess[0].0, ImuBias::default());
        batch.know(first, [a, b, c, v, v, v, x, y, z], [gx, gy, gz, ax, ay, az])?;
        for (track, landmark) in &self.landmarks {
            let seen = landmark.seen.iter().map(|(state, u, v)| (*state, Vector2::new(*u, *v)));
            let sightings: Vec<_> = seen.collect();
            let kernel = Kernel::Huber(self.huber);
            batch.add_landmark(*track, landmark.start.into(), &sightings, kernel)?;
        }
        Ok(batch)
    }

    /// The largest and the root mean square difference of positions from GTSAM's.
    fn differences(&self, estimate: &Estimate) -> [f64; 2] {
        let both = self.batch.iter().zip(&estimate.states).zip(&estimate.pose_covariances);
        let squares = both.map(|((theirs, ours), covariance)| {
            let off: Vector3<f64> = ours.position - Vector3::from(theirs.position);
            let spread: Matrix3<f64> = covariance.fixed_view::<3, 3>(3, 3).into();
            spread.cholesky().map_or(f64::NAN, |spread| off.dot(&spread.solve(&off)))
        });
        let squares: Vec<f64> = squares.collect();
        let largest = squares.iter().fold(0.0, |largest: f64, square| largest.max(*square));
        let sum: f64 = squares.iter().sum();
        [largest.sqrt(), (sum / (3 * squares.len()) as f64).sqrt()]
    }
}
