//! What an odometry says of a flight, picture by picture.

use std::time::Instant;

use vislam::datasets::tracks::Picture;
use vislam::inertial::{CameraImu, NavState, StampedSample};
use vislam::initialization::Sensors;
use vislam::msckf::Start;
use vislam::odometry::{Estimate, Estimator, Odometry, OdometryError, OdometryOptions, Progress};
use vislam::simulation::FlightRecording;

/// The age of what is called delayed, in seconds.
pub const DELAY: f64 = 2.0;

/// What was said of a flight. What was lost is counted, and left out.
#[derive(Default)]
pub struct Followed {
    /// By the number of a picture: the newest state when it had come.
    pub causal: Vec<(usize, Estimate)>,
    /// By the number of a picture: its state when it was [`DELAY`] old.
    pub delayed: Vec<(usize, NavState)>,
    pub losses: usize,
    /// Seconds of computing since it follows, and the pictures meanwhile.
    pub seconds: f64,
    pub pictures: usize,
}

impl Followed {
    /// What an odometry makes of readings and pictures.
    pub fn of(
        odometry: &mut Odometry,
        readings: &[StampedSample],
        pictures: &[Picture],
        rig: &CameraImu,
    ) -> Result<Self, OdometryError> {
        let times = pictures.iter().map(|picture| rig.imu_nanoseconds(picture.nanoseconds));
        let times: Vec<i64> = times.collect();
        // A filter that estimates the camera's clock has its states at times of its own.
        let half = times.windows(2).map(|pair| (pair[1] - pair[0]) / 2).min().unwrap_or(0);
        let number = |time: i64| {
            let at = times.partition_point(|other| other + half < time);
            times.get(at).filter(|other| (*other - time).abs() <= half).map(|_| at)
        };
        let mut followed = Self::default();
        let mut since = Instant::now();
        odometry.fly(readings, pictures, |odometry, progress| match progress {
            Progress::Waiting | Progress::Standing => since = Instant::now(),
            Progress::Lost(_) => followed = Self { losses: followed.losses + 1, ..Self::default() },
            Progress::Following { .. } => {
                followed.note(odometry, number);
                // What a beginning takes is not the time of a picture.
                match followed.causal.len() {
                    1 => since = Instant::now(),
                    _ => followed.pictures += 1,
                }
                followed.seconds = since.elapsed().as_secs_f64();
            }
        })?;
        Ok(followed)
    }

    fn note(&mut self, odometry: &Odometry, number: impl Fn(i64) -> Option<usize>) {
        let Some(newest) = odometry.newest() else { return };
        let is_later = |number: &usize| self.causal.last().is_none_or(|(last, _)| last < number);
        let Some(at) = number(newest.nanoseconds).filter(is_later) else { return };
        self.causal.push((at, newest));
        let Some((time, state)) = odometry.ago(DELAY) else { return };
        let is_old = newest.nanoseconds - time >= (1e9 * DELAY) as i64;
        let is_later = |number: &usize| self.delayed.last().is_none_or(|(last, _)| last < number);
        if let Some(at) = number(time).filter(|at| is_old && is_later(at)) {
            self.delayed.push((at, state));
        }
    }

    /// What estimators of these options make of a simulated flight from a start that is known to them.
    pub fn simulated(
        recording: &FlightRecording,
        options: OdometryOptions,
        start: &Start,
    ) -> Result<Self, OdometryError> {
        let rig = options.sensors.rig;
        let mut odometry = Odometry::begun(options, start)?;
        let pictures = &recording.pictures[1..];
        let mut followed = Self::of(&mut odometry, &recording.readings, pictures, &rig)?;
        let numbers = followed.causal.iter_mut().map(|(number, _)| number);
        numbers.chain(followed.delayed.iter_mut().map(|(number, _)| number)).for_each(|n| *n += 1);
        Ok(followed)
    }
}

/// The options that are true of a simulated flight.
pub fn options(recording: &FlightRecording, estimator: Estimator) -> OdometryOptions {
    OdometryOptions::new(Sensors::of_flight(&recording.flight), estimator)
}

/// The root of the mean of the squares of position errors, in metres.
pub fn rmse<'a>(states: impl Iterator<Item = (usize, &'a NavState)>, truth: &[NavState]) -> f64 {
    let squares = states.map(|(at, state)| (state.position - truth[at].position).norm_squared());
    let (sum, count) = squares.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
    (sum / f64::from(count)).sqrt()
}
