//! The estimators, and what each of them says.

use nalgebra::{Matrix6, Vector3};
use vislam::inertial::NavState;
use vislam::initialization::{Batch, BeginOptions, Whole, WholeOptions, begin};
use vislam::least_squares::{Covariance, Values};
use vislam::odometry::{Estimator, Odometry, OdometryOptions, Progress};
use vislam::preintegration::Matrix15;

use super::input::Input;

/// States and their times, in nanoseconds on the sensor's clock.
pub type Trajectory = Vec<(i64, NavState)>;

/// The age of what is called delayed, in seconds.
pub const DELAY: f64 = 2.0;

/// What an estimator says.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Times of the states, in nanoseconds on the sensor's clock.
    pub nanoseconds: Vec<i64>,
    pub states: Vec<NavState>,
    /// Of the poses, by the steps of [`vislam::inertial::BodyPose`].
    pub pose_covariances: Vec<Matrix6<f64>>,
    /// In the world, in metres.
    pub landmarks: Vec<Vector3<f64>>,
    /// Seconds from the first picture until there was an estimate; NaN when it was given.
    pub initialized_after: f64,
    /// The standard deviation of the scale then, as a part of it; NaN when none was estimated.
    pub scale_sigma: f64,
    /// Each state when it was the newest.
    pub causal: Trajectory,
    /// Each state when it was [`DELAY`] old.
    pub delayed: Trajectory,
}

/// Estimates a flight. Meanwhile it is told what is being done.
pub fn run(
    estimator: Estimator,
    input: &Input,
    progress: &mut dyn FnMut(&str),
) -> Result<Estimate, String> {
    let followed = follow(estimator, input, progress)?;
    match estimator {
        Estimator::Batch => {
            let Estimate { causal, delayed, .. } = followed;
            Ok(Estimate { causal, delayed, ..batch(input, progress)? })
        }
        Estimator::Smoother | Estimator::Msckf => Ok(followed),
    }
}

/// Follows a flight picture by picture. What was lost is said, and what comes after it is in a world of
/// its own: the one with the most states is kept.
fn follow(
    estimator: Estimator,
    input: &Input,
    progress: &mut dyn FnMut(&str),
) -> Result<Estimate, String> {
    let Input { sensors, readings, pictures, .. } = input;
    let mut options = OdometryOptions::new(*sensors, estimator);
    options.smoother.right = input.right;
    let mut odometry = Odometry::new(options);
    let (mut estimate, mut lost) = (Estimate::nothing(), Vec::new());
    let mut last = None;
    let told = |odometry: &Odometry, what: Progress| {
        last = Some(what.clone());
        match what {
            Progress::Following { .. } | Progress::Standing => estimate.add(odometry),
            Progress::Lost(why) => {
                eprintln!("lost after {} states: {why}", estimate.states.len());
                lost.push(std::mem::replace(&mut estimate, Estimate::nothing()));
            }
            Progress::Waiting => {}
        }
        progress(&format!("{} states of {}", estimate.states.len(), pictures.len()));
    };
    odometry.fly(readings, pictures, told).map_err(|error| error.to_string())?;
    let worlds = lost.into_iter().chain([estimate]).filter(Estimate::has_begun);
    worlds.max_by_key(|world| world.states.len()).ok_or_else(|| match last {
        Some(Progress::Standing) => "there is no flight: the body stands until the end".to_owned(),
        _ => {
            "there is no beginning: the body neither stands nor moves enough; give a longer flight"
                .to_owned()
        }
    })
}

/// Begins at rest or in motion, and from there grows the batch of all pictures.
fn batch(input: &Input, progress: &mut dyn FnMut(&str)) -> Result<Estimate, String> {
    let Input { sensors, readings, pictures, .. } = input;
    progress("looking for a beginning");
    let begun = begin(sensors, readings, pictures, &BeginOptions::default())
        .map_err(|error| format!("there is no beginning: {error}"))?;
    progress(&format!("begun after {:.2} s; growing the batch", begun.seconds));
    let options = WholeOptions::default();
    let told = |states| progress(&format!("{states} of {} states", pictures.len()));
    let whole = Whole::grown_with(sensors, readings, pictures, begun.known, &options, told)
        .map_err(|error| format!("there is no batch of the whole flight: {error}"))?;
    let rig = sensors.rig;
    let times = pictures.iter().map(|picture| rig.imu_nanoseconds(picture.nanoseconds));
    let estimate =
        Estimate::of_batch(times.collect(), &whole.batch, &whole.values, &whole.covariance);
    Ok(Estimate {
        initialized_after: begun.seconds,
        scale_sigma: begun.scale_sigma.unwrap_or(f64::NAN),
        ..estimate
    })
}

/// The covariance of a pose, from that of a state, whose step is (φ, v, p), and what follows it.
fn of_pose(all: impl Fn(usize, usize) -> f64) -> Matrix6<f64> {
    let place = |coordinate: usize| if coordinate < 3 { coordinate } else { coordinate + 3 };
    Matrix6::from_fn(|row, column| all(place(row), place(column)))
}

impl Estimate {
    pub fn nothing() -> Self {
        Self {
            nanoseconds: Vec::new(),
            states: Vec::new(),
            pose_covariances: Vec::new(),
            landmarks: Vec::new(),
            initialized_after: f64::NAN,
            scale_sigma: f64::NAN,
            causal: Trajectory::new(),
            delayed: Trajectory::new(),
        }
    }

    /// Whether a flight began, and was not only stood through.
    fn has_begun(&self) -> bool {
        self.initialized_after.is_finite()
    }

    /// Adds what an odometry says after a picture.
    fn add(&mut self, odometry: &Odometry) {
        let is_new = |time| self.nanoseconds.last().is_none_or(|last| *last < time);
        let newest = odometry.newest().filter(|newest| is_new(newest.nanoseconds));
        let Some(newest) = newest else { return };
        if let Some(beginning) = odometry.beginning() {
            self.initialized_after = beginning.seconds;
            self.scale_sigma = beginning.scale_sigma.unwrap_or(f64::NAN);
        }
        let covariance: Matrix15 = newest.covariance;
        self.nanoseconds.push(newest.nanoseconds);
        self.states.push(newest.state);
        self.pose_covariances.push(of_pose(|row, column| covariance[(row, column)]));
        self.causal.push((newest.nanoseconds, newest.state));
        let is_new = |(time, _): &(i64, NavState)| {
            newest.nanoseconds - time >= (1e9 * DELAY) as i64
                && self.delayed.last().is_none_or(|(last, _)| last < time)
        };
        self.delayed.extend(odometry.ago(DELAY).filter(is_new));
    }

    /// What a batch says at its minimum.
    pub fn of_batch(
        nanoseconds: Vec<i64>,
        batch: &Batch,
        values: &Values,
        covariance: &Covariance,
    ) -> Self {
        let pose_covariance = |state| {
            let all = covariance.of(state);
            all.map_or(Matrix6::repeat(f64::NAN), |all| of_pose(|row, column| all[(row, column)]))
        };
        Self {
            nanoseconds,
            states: batch.states.iter().map(|state| values[*state]).collect(),
            pose_covariances: batch.states.iter().map(|state| pose_covariance(*state)).collect(),
            landmarks: batch.landmarks.values().map(|landmark| values[*landmark]).collect(),
            ..Self::nothing()
        }
    }
}
