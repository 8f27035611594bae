//! What the sensors of a flight bring home, and the truth about it.

use nalgebra::Vector3;

use super::Flight;
use crate::datasets::tracks::Picture;
use crate::inertial::{ImuBias, NavState, StampedSample};

/// What the sensors of a flight bring home.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightRecording {
    /// The flight, with the noise and the calibration of its sensors.
    pub flight: Flight,
    /// The readings in the order of their times. A reading is what the sensor feels at its time,
    /// and not the mean of a step.
    pub readings: Vec<StampedSample>,
    /// The pictures in the order of their times, on the clock of the camera; on that of the inertial
    /// sensor they are at
    /// [`CameraImu::imu_nanoseconds`](crate::inertial::CameraImu::imu_nanoseconds) of these. Features
    /// are in pixels. A landmark keeps its track for as long as one picture after another shows it;
    /// when it comes back after a picture without it, it has a new one.
    pub pictures: Vec<Picture>,
    /// What an estimator must not know.
    pub truth: Truth,
}

/// The truth about a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// The state of the body at each picture.
    pub states: Vec<NavState>,
    /// The biases at each picture: those of the last reading until then.
    pub biases: Vec<ImuBias>,
    /// Where the landmarks are, in the world, in metres.
    pub landmarks: Vec<Vector3<f64>>,
    /// Which landmark a track follows.
    pub landmark_of_track: Vec<usize>,
    /// The observations that are outliers, ascending: the index of the picture and the track.
    pub outliers: Vec<(usize, usize)>,
}
