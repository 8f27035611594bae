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
/// For how long something goes wrong, in seconds.
const FAULT: f64 = 1.0;
/// The last moment at which something begins to, in seconds.
pub const LAST_FAULT: f64 = 28.0;
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

/// What goes wrong, in the order of its buttons.
#[derive(Debug, Clone, Copy)]
pub enum Fault {
    /// Pictures are missing.
    Pictures,
    /// Each track is somewhere else in each picture.
    Tracks,
    /// Readings are missing.
    Readings,
}

/// All that can.
pub const FAULTS: [Fault; 3] = [Fault::Pictures, Fault::Tracks, Fault::Readings];

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
    /// When each fault was asked for, in seconds; before the flight if it was not.
    pub faults: [f64; 3],
    /// Of all that is random.
    pub seed: u64,
}

impl Setting {
    /// The setting and the number of the last picture, from the values of the controls.
    pub fn of(controls: &[f64]) -> Option<(Self, usize)> {
        let &[time, pictures, tracks, readings, estimator, pixel, track, milliseconds, clock, seed] =
            controls
        else {
            return None;
        };
        let estimator = match estimator.round() as usize {
            0 => Estimator::Smoother,
            _ => Estimator::Msckf,
        };
        let setting = Self {
            estimator,
            pixel,
            track: track.round() as usize,
            delay: 1e-3 * milliseconds,
            clock: clock.round() > 0.0,
            faults: [pictures, tracks, readings],
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

    /// From when to when something goes wrong, in seconds, if it was asked for. It begins between pictures, after the one
    /// that a reader has not seen yet: what was seen stays.
    pub fn span(&self, fault: Fault) -> Option<[f64; 2]> {
        let moment = self.faults[fault as usize];
        let from = ((moment * PICTURES + 1e-9).floor() + 1.5) / PICTURES;
        (moment >= 0.0).then_some([from, from + FAULT])
    }

    /// Whether something goes wrong.
    pub fn suffers(&self, fault: Fault, seconds: f64) -> bool {
        self.span(fault).is_some_and(|[from, to]| (from..to).contains(&seconds))
    }

    /// By how much a pixel of a picture is off, if it is: elsewhere in each picture.
    pub fn off(&self, seconds: f64, picture: usize, feature: usize) -> Option<Vector2<f64>> {
        let (sine, cosine) = ((7 * feature + 3 * picture) as f64).sin_cos();
        self.suffers(Fault::Tracks, seconds).then(|| OFF * Vector2::new(sine, cosine))
    }

    /// Whether this and another are the same until some time, in seconds.
    pub fn agrees(&self, other: &Self, seconds: f64) -> bool {
        let begins = |setting: &Self, fault| setting.span(fault).map_or(f64::MAX, |[from, _]| from);
        let agree = |fault| {
            let [one, two] = [self, other].map(|setting| begins(setting, fault));
            one == two || one.min(two) > seconds
        };
        Self { faults: other.faults, ..*self } == *other && FAULTS.into_iter().all(agree)
    }
}
