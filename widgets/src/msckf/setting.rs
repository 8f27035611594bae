//! What the controls ask for: a flight, and a filter.

use nalgebra::Vector3;
use vislam::consistency::Policy;
use vislam::inertial::ImuNoise;
use vislam::msckf::MsckfOptions;
use vislam::simulation::{Flight, FlightError, Recorder, Trajectory};

/// How long the flight is, in seconds.
pub const SECONDS: f64 = 30.0;
/// Pictures in a second.
pub const PICTURES: f64 = 10.0;
/// The standard deviations of what is known at the beginning: turns, velocity and position, in rad, m/s and m, and the
/// biases of gyroscope and accelerometer, in rad/s and m/s². A velocity that is known well in the world would say something
/// of the yaw.
pub const SIGMAS: [f64; 15] =
    [0.01, 0.01, 0.015, 0.15, 0.15, 0.15, 0.01, 0.01, 0.01, 2e-3, 2e-3, 2e-3, 0.02, 0.02, 0.02];
/// Metres from the flight to the walls of its room, and landmarks on them.
const ROOM: (f64, usize) = (3.0, 240);
/// The probability that a track without fault passes the gate.
const GATE: f64 = 0.99;
/// Landmarks that stay in the state, if any do.
const KEPT: usize = 10;

/// All controls but the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Poses that the filter keeps, and so the most pictures of a track.
    pub window: usize,
    /// Features in a picture, at most.
    pub features: usize,
    /// The standard deviation of each coordinate of a pixel.
    pub pixel: f64,
    /// Densities of the noise of the inertial sensor over those of the EuRoC flights.
    pub imu: f64,
    /// The share of the pixels that are anywhere in the picture.
    pub outliers: f64,
    /// Whether tracks are asked whether they contradict what is believed.
    pub gate: bool,
    /// Landmarks that stay in the state, at most.
    pub landmarks: usize,
    /// Where derivatives are taken.
    pub policy: Policy,
    /// Of all that is random.
    pub seed: u64,
}

impl Setting {
    /// The setting and the number of the last picture, from the values of the controls.
    pub fn of(controls: &[f64]) -> Option<(Self, usize)> {
        let &[time, window, features, pixel, imu, percent, gate, kept, seed] = controls else {
            return None;
        };
        let (landmarks, policy) = match kept.round() as usize {
            0 => (0, Policy::Standard),
            1 => (KEPT, Policy::Standard),
            _ => (KEPT, Policy::FirstEstimates),
        };
        let setting = Self {
            window: window.round() as usize,
            features: features.round() as usize,
            pixel,
            imu,
            outliers: percent / 100.0,
            gate: gate.round() > 0.0,
            landmarks,
            policy,
            seed: seed.round() as u64,
        };
        Some((setting, (time * PICTURES + 1e-9) as usize))
    }

    /// The flight before it begins.
    pub fn recorder(&self) -> Result<Recorder, FlightError> {
        let flight = self.flight();
        let (margin, count) = ROOM;
        Recorder::new(&flight, &flight.room(margin, count, self.seed)?, self.seed)
    }

    fn flight(&self) -> Flight {
        let euroc = ImuNoise::euroc();
        let noise = ImuNoise {
            gyro: self.imu * euroc.gyro,
            accelerometer: self.imu * euroc.accelerometer,
            gyro_walk: self.imu * euroc.gyro_walk,
            accelerometer_walk: self.imu * euroc.accelerometer_walk,
        };
        let lever = Vector3::new(0.1, 0.05, -0.02);
        Flight {
            seconds: SECONDS,
            picture_rate: PICTURES,
            noise,
            pixel_sigma: self.pixel,
            tracks: self.features,
            outliers: self.outliers,
            ..Flight::new(Trajectory::figure_eight()).with_lever(lever)
        }
    }

    /// The filter, which is told the truth about all noise.
    pub fn options(&self, flight: &Flight) -> MsckfOptions {
        MsckfOptions {
            clones: self.window,
            gate: if self.gate { GATE } else { 1.0 },
            landmarks: self.landmarks,
            linearization: self.policy.into(),
            ..MsckfOptions::of_flight(flight)
        }
    }
}
