//! The flights, and the filters that follow them.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use vislam::consistency::Policy;
use vislam::inertial::ImuNoise;
use vislam::msckf::{Msckf, MsckfError, MsckfOptions, PictureReport, Start};
use vislam::simulation::{Flight, FlightError, FlightRecording, Trajectory};

// ANCHOR: setting
/// A cell of the experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Densities of the noise of the readings and of the walk of their biases.
    pub noise: ImuNoise,
    /// The standard deviation of each coordinate of a pixel.
    pub pixel_sigma: f64,
    /// A landmark is called by another name after so many pictures.
    pub longest_track: usize,
    /// Poses in the window.
    pub clones: usize,
    /// Landmarks that are kept in the state, at most.
    pub landmarks: usize,
    /// Standard deviations at the beginning, of [`Start::at_the_origin`].
    pub start: [f64; 4],
}

impl Default for Setting {
    /// A good sensor, one pixel, tracks as long as they are seen, eleven poses, no kept landmarks,
    /// and a start as an initialization leaves it.
    fn default() -> Self {
        Self {
            noise: ImuNoise::euroc(),
            pixel_sigma: 1.0,
            longest_track: usize::MAX,
            clones: 11,
            landmarks: 0,
            start: ESTIMATED,
        }
    }
}

/// Tilt, velocity, and the biases of gyroscope and accelerometer, as an initialization leaves them.
pub const ESTIMATED: [f64; 4] = [0.01, 0.05, 2e-3, 0.02];

/// The same, a thousand times better.
pub const PERFECT: [f64; 4] = [1e-5, 5e-5, 2e-6, 2e-5];
// ANCHOR_END: setting

pub const PICTURE_RATE: f64 = 5.0;
const LANDMARKS: usize = 800;
const TRACKS: usize = 40;

/// Of the flights at constant velocity, in m/s.
pub const SPEED: f64 = 1.0;

/// How the body moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Every axis turns and accelerates.
    FigureEight,
    /// Straight ahead, turning as in the figure-eight: the readings do not show the scale.
    ConstantVelocity,
}

impl Motion {
    fn trajectory(self) -> Trajectory {
        let eight = Trajectory::figure_eight();
        match self {
            Self::FigureEight => eight,
            Self::ConstantVelocity => {
                Trajectory::constant_velocity(&Vector3::new(SPEED, 0.0, 0.0), eight.angles)
            }
        }
    }
}

// ANCHOR: flown
/// What the sensors of a flight in a room bring home.
pub fn flown(
    motion: Motion,
    setting: &Setting,
    seconds: f64,
    seed: u64,
) -> Result<FlightRecording, FlightError> {
    let Setting { noise, pixel_sigma, .. } = *setting;
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let new = Flight::new(motion.trajectory()).with_lever(lever);
    let flight =
        Flight { seconds, noise, pixel_sigma, picture_rate: PICTURE_RATE, tracks: TRACKS, ..new };
    let recording = flight.record(&flight.room(3.0, LANDMARKS, seed)?, seed)?;
    Ok(shortened(recording, setting.longest_track))
}
// ANCHOR_END: flown

/// The same recording with landmarks called by another name after so many pictures.
fn shortened(mut recording: FlightRecording, longest: usize) -> FlightRecording {
    let truth = &mut recording.truth;
    let mut names: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for picture in &mut recording.pictures {
        for feature in &mut picture.features {
            let (name, seen) = names.entry(feature.track).or_insert((feature.track, 0));
            if *seen >= longest {
                (*name, *seen) = (truth.landmark_of_track.len(), 0);
                truth.landmark_of_track.push(truth.landmark_of_track[feature.track]);
            }
            *seen += 1;
            feature.track = *name;
        }
        picture.features.sort_by_key(|feature| feature.track);
    }
    recording
}

/// What is believed when a recording begins.
pub fn start(recording: &FlightRecording, setting: &Setting, seed: u64) -> Option<Start> {
    Start::at_the_origin(recording, setting.start, 1000 + seed)
}

// ANCHOR: follow
/// Gives a filter with a policy the readings and pictures of a recording, and visits it after each
/// picture.
pub fn follow(
    recording: &FlightRecording,
    setting: &Setting,
    policy: Policy,
    seed: u64,
    mut visit: impl FnMut(usize, &Msckf, &PictureReport),
) -> Result<(), MsckfError> {
    let options = MsckfOptions {
        clones: setting.clones,
        landmarks: setting.landmarks,
        gate: 1.0,
        linearization: policy.into(),
        ..MsckfOptions::of_flight(&recording.flight)
    };
    let start = start(recording, setting, seed).ok_or(MsckfError::NoTruth { picture: 0 })?;
    let mut filter = Msckf::new(options, &start)?;
    let mut number = 0;
    while let Some(report) = filter.follow(recording, number)? {
        visit(number, &filter, &report);
        number += 1;
    }
    Ok(())
}
// ANCHOR_END: follow
