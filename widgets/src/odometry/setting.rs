//! What the controls ask for: a flight, what goes wrong on it, and an estimator.

use nalgebra::{Vector2, Vector3};
use vislam::inertial::{Calibrated, CameraImu};
use vislam::initialization::{BeginOptions, Sensors};
use vislam::odometry::{Estimator, OdometryOptions};
use vislam::simulation::{Flight, FlightError, Recorder, Trajectory};

/// How long the flight is shown at most, in seconds.
pub const SECONDS: f64 = 30.0;
/// Pictures in a second.
pub const PICTURES: f64 = 5.0;
/// When the body stands, in seconds: before it sets out, and once on its way.
pub const STANDS: [[f64; 2]; 2] = [[-1.0, 2.0], [17.0, 20.0]];
/// How long it must stand to begin, which the shortest tracks do not outlast by much.
pub const STAND: f64 = 0.6;
/// From when to when something goes wrong, if it does, in seconds.
pub const FAULT: [f64; 2] = [12.0, 13.0];
/// Metres from the flight to the walls of its room, and landmarks on them.
const ROOM: (f64, usize) = (3.0, 240);
/// Features in a picture, at most.
const FEATURES: usize = 20;
/// By so much a wrong pixel is off, in pixels.
const OFF: f64 = 150.0;
/// How well an estimator knows the clock of the camera when it is to estimate it, in seconds.
const CLOCK_SIGMA: f64 = 0.03;
/// A reading that would still be needed for the last picture may come later.
const BEHIND: f64 = 0.5;

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    None,
    /// Pictures are missing.
    Pictures,
    /// Each track is somewhere else in each picture.
    Tracks,
    /// Readings are missing.
    Readings,
}

/// All controls but the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// What follows the flight once it has begun.
    pub estimator: Estimator,
    /// The standard deviation of each coordinate of a pixel.
    pub pixel: f64,
    /// After so many pictures the tracker loses a landmark, and finds it again as another one.
    pub track: usize,
    /// How late the clock of the camera is, in seconds. Nobody tells the estimator.
    pub delay: f64,
    /// Whether the estimator looks for that itself.
    pub clock: bool,
    /// What goes wrong.
    pub fault: Fault,
    /// Of all that is random.
    pub seed: u64,
}

impl Setting {
    /// The setting and the number of the last picture, from the values of the controls.
    pub fn of(controls: &[f64]) -> Option<(Self, usize)> {
        let &[time, estimator, pixel, track, milliseconds, clock, fault, seed] = controls else {
            return None;
        };
        let estimator = match estimator.round() as usize {
            0 => Estimator::Smoother,
            _ => Estimator::Msckf,
        };
        let fault = match fault.round() as usize {
            0 => Fault::None,
            1 => Fault::Pictures,
            2 => Fault::Tracks,
            _ => Fault::Readings,
        };
        let setting = Self {
            estimator,
            pixel,
            track: track.round() as usize,
            delay: 1e-3 * milliseconds,
            clock: clock.round() > 0.0,
            fault,
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
        let lever = Vector3::new(0.1, 0.05, -0.02);
        let flight = Flight::new(Trajectory::figure_eight().with_stands(&STANDS));
        let flight = flight.with_lever(lever);
        Flight {
            seconds: SECONDS + BEHIND,
            picture_rate: PICTURES,
            pixel_sigma: self.pixel,
            tracks: FEATURES,
            rig: CameraImu { time_offset: self.delay, ..flight.rig },
            gap: (self.fault == Fault::Readings).then_some(FAULT),
            ..flight
        }
    }

    /// The estimator, which is told the truth about all noise, and that the clocks agree.
    pub fn options(&self, flight: &Flight) -> OdometryOptions {
        let known = Sensors::of_flight(flight);
        let time_offset = self.clock.then_some(CLOCK_SIGMA);
        let sensors = Sensors {
            rig: CameraImu { time_offset: 0.0, ..known.rig },
            calibrated: Calibrated { time_offset, ..known.calibrated },
            ..known
        };
        let begin = BeginOptions { stand: STAND, ..BeginOptions::at_rest() };
        OdometryOptions::beginning(sensors, self.estimator, begin)
    }

    /// Whether a picture is never taken.
    pub fn loses(&self, seconds: f64) -> bool {
        self.fault == Fault::Pictures && is_faulty(seconds)
    }

    /// By how much a pixel of a picture is off, if it is: elsewhere in each picture.
    pub fn off(&self, seconds: f64, picture: usize, feature: usize) -> Option<Vector2<f64>> {
        let (sine, cosine) = ((7 * feature + 3 * picture) as f64).sin_cos();
        let is_wrong = self.fault == Fault::Tracks && is_faulty(seconds);
        is_wrong.then(|| OFF * Vector2::new(sine, cosine))
    }
}

fn is_faulty(seconds: f64) -> bool {
    let [from, to] = FAULT;
    (from..to).contains(&seconds)
}
