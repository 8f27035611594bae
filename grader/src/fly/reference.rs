//! What an estimator of the book makes of a flight: with what others can be compared.

use nalgebra::Matrix6;
use vislam::inertial::NavState;
use vislam::initialization::Sensors;
use vislam::odometry::{Estimate, Estimator, Odometry, OdometryOptions, Progress};
use vislam::simulation::FlightRecording;

/// A pose at a time, and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// The time on the sensor's clock, in nanoseconds.
    pub nanoseconds: i64,
    /// The pose of the body; its velocity is zero and means nothing.
    pub state: NavState,
    /// The 6×6 covariance of a turn in the body and the position in the world.
    pub covariance: Matrix6<f64>,
}

/// The poses that an estimator has when each is the newest, of the last world that it begins.
///
/// # Errors
///
/// A sentence when it does not take the flight.
pub fn followed(recording: &FlightRecording, estimator: Estimator) -> Result<Vec<Line>, String> {
    let sensors = Sensors::of_flight(&recording.flight);
    followed_with(recording, OdometryOptions::new(sensors, estimator))
}

/// The same with options.
///
/// # Errors
///
/// As [`followed`].
pub fn followed_with(
    recording: &FlightRecording,
    options: OdometryOptions,
) -> Result<Vec<Line>, String> {
    let mut odometry = Odometry::new(options);
    let mut lines: Vec<Line> = Vec::new();
    let told = |odometry: &Odometry, progress| {
        if matches!(progress, Progress::Lost(_)) {
            lines.clear();
        }
        let last = lines.last().map(|line| line.nanoseconds);
        let newest = odometry.newest().filter(|newest| Some(newest.nanoseconds) > last);
        lines.extend(newest.as_ref().map(line));
    };
    let flown = odometry.fly(&recording.readings, &recording.pictures, told);
    flown.map_err(|error| error.to_string()).map(|()| lines)
}

/// The pose of an estimate and its covariance.
pub fn line(estimate: &Estimate) -> Line {
    let place = |coordinate: usize| if coordinate < 3 { coordinate } else { coordinate + 3 };
    let covariance =
        Matrix6::from_fn(|row, column| estimate.covariance[(place(row), place(column))]);
    Line { nanoseconds: estimate.nanoseconds, state: estimate.state, covariance }
}
