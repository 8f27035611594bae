//! The flights of a student: drawn from a key, flown again whenever the truth is asked for.

use nalgebra::{Isometry3, Rotation3, Translation3, Vector3};
use vislam::inertial::{ImuBias, ImuNoise, NavState};
use vislam::simulation::{
    EulerAngles, Flight, FlightRecording, ScalarTrajectory as Along, Trajectory,
};

use super::key::{Draws, Key};

/// Flights of each student.
pub const FLIGHTS: usize = 10;
/// How long each lasts, in seconds.
pub const SECONDS: f64 = 20.0;
/// The body stands for so many seconds at the beginning, level, and then gets going.
pub const STAND: f64 = 2.0;
/// How late the clock of the camera may be, in seconds.
pub const LATE: [f64; 2] = [0.025, 0.045];
/// The share of pixels that are wrong where some are.
pub const OUTLIERS: f64 = 0.03;
/// The standard deviations of the biases at the beginning, in rad/s and m/s².
pub const BIASES: [f64; 2] = [0.01, 0.05];

/// A sensor of the poorer kind: what its white noise does in a flight shows.
pub const NOISE: ImuNoise =
    ImuNoise { gyro: 2.0e-3, accelerometer: 1.0e-2, gyro_walk: 1.0e-4, accelerometer_walk: 2.0e-3 };

/// The stand as the motion knows it: since before the flight.
const STANDS: [[f64; 2]; 1] = [[-STAND, STAND]];
/// The time of the motion at which it stands: it has slowed down for half a second before.
const STOOD: f64 = -STAND - 0.5;
const LANDMARKS: usize = 800;

/// What is wrong with a flight, and is said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Announced {
    /// Nothing.
    Nothing,
    /// Some pixels are anywhere.
    Outliers,
    /// The camera's clock is late.
    LateClock,
    /// No reading comes for a while, from and to in seconds.
    Gap([f64; 2]),
}

/// A flight that is graded.
#[derive(Debug, Clone)]
pub struct Graded {
    /// What is wrong with it.
    pub announced: Announced,
    /// What is added to all times, in nanoseconds: flights of others have others.
    pub begins: i64,
    flight: Flight,
    seed: u64,
}

impl Graded {
    /// A flight of a folder, counted from zero.
    pub fn of(key: &Key, folder: &str, number: usize) -> Self {
        let mut draws = key.draws(folder, number);
        let announced = announced(number, &mut draws);
        let motion = motion(number, &mut draws).with_stands(&STANDS);
        let mut flight = Flight {
            seconds: SECONDS,
            picture_rate: 10.0,
            tracks: 30,
            noise: NOISE,
            initial_bias: bias(&mut draws),
            ..Flight::new(motion)
        };
        flight.rig.body_from_camera = mounted(&flight.rig.body_from_camera, &mut draws);
        match announced {
            Announced::Nothing => {}
            Announced::Outliers => flight.outliers = OUTLIERS,
            Announced::LateClock => {
                // A millisecond is a whole number of readings' parts, and easily read.
                let late = draws.between(LATE[0], LATE[1]);
                flight.rig.time_offset = (1e3 * late).round() / 1e3;
            }
            Announced::Gap(gap) => flight.gap = Some(gap),
        }
        let begins = 1_000_000_000_000 * (1 + draws.word() % 100_000) as i64;
        Self { announced, begins, flight, seed: draws.word() }
    }

    /// All flights of a folder.
    pub fn all(key: &Key, folder: &str) -> Vec<Self> {
        (0..FLIGHTS).map(|number| Self::of(key, folder, number)).collect()
    }

    /// What the sensors bring home, and the truth about it.
    ///
    /// # Errors
    ///
    /// A sentence when it cannot be flown.
    pub fn flown(&self) -> Result<FlightRecording, String> {
        let landmarks = self.flight.room(3.0, LANDMARKS, self.seed);
        let recording = landmarks.and_then(|landmarks| self.flight.record(&landmarks, self.seed));
        let mut recording = recording.map_err(|error| error.to_string())?;
        recording.readings.iter_mut().for_each(|reading| reading.nanoseconds += self.begins);
        recording.pictures.iter_mut().for_each(|picture| picture.nanoseconds += self.begins);
        Ok(recording)
    }

    /// How the camera sits on the body and how its clock goes.
    pub fn rig(&self) -> vislam::inertial::CameraImu {
        self.flight.rig
    }

    /// Seconds of the flight at a time of the sensor's clock.
    pub fn seconds(&self, nanoseconds: i64) -> f64 {
        1e-9 * nanoseconds.saturating_sub(self.begins) as f64
    }

    /// The true state at such a time, in the world of a body that calls where it stands the origin and
    /// where it looks ahead.
    pub fn truth(&self, nanoseconds: i64) -> NavState {
        self.flight.motion.at(self.seconds(nanoseconds)).state
    }

    /// The angular velocity of the body at such a time, in its frame, in rad/s.
    pub fn turning(&self, nanoseconds: i64) -> Vector3<f64> {
        self.flight.motion.at(self.seconds(nanoseconds)).angular_velocity
    }

    /// From when on the flight is to be estimated, in seconds: since its end nothing is missing.
    pub fn from(&self) -> f64 {
        match self.announced {
            Announced::Gap([_, to]) => to,
            _ => 0.0,
        }
    }
}

/// What is wrong with a flight of this number. Most of the first have nothing.
fn announced(number: usize, draws: &mut Draws) -> Announced {
    match number {
        4 | 5 => Announced::Outliers,
        6 | 7 => Announced::LateClock,
        8.. => {
            let from = (10.0 * draws.between(5.0, 6.0)).round() / 10.0;
            Announced::Gap([from, from + 1.0])
        }
        _ => Announced::Nothing,
    }
}

/// A wave that is zero where the body stands.
fn wave(amplitude: f64, frequency: f64) -> Along {
    Along::wave(amplitude, frequency, -frequency * STOOD)
}

/// A coordinate that is zero where the body stands, and grows.
fn line(rate: f64) -> Along {
    Along { value: -rate * STOOD, ..Along::linear(rate) }
}

/// One of four motions, each time of another size and pace.
fn motion(number: usize, draws: &mut Draws) -> Trajectory {
    let mut near = |value: f64| value * draws.between(0.85, 1.15);
    let pace = near(0.8);
    let position = match number % 4 {
        // A figure-eight.
        0 => [wave(near(3.0), pace), wave(near(1.5), 2.0 * pace), wave(near(0.5), near(1.1))],
        // A circle that rises and falls.
        1 => {
            let radius = near(2.0);
            let across = Along::wave(radius, pace, -pace * STOOD - std::f64::consts::FRAC_PI_2);
            [wave(radius, pace), Along { value: radius, ..across }, wave(near(0.4), near(1.3))]
        }
        // Along a hall, with turns.
        2 => [line(near(0.5)), wave(near(1.2), pace), wave(near(0.4), near(1.2))],
        // Up a staircase, to and fro.
        _ => [
            wave(near(2.0), pace),
            wave(near(1.0), near(1.3)),
            Along { value: -0.1 * STOOD, rate: 0.1, ..wave(near(0.3), near(1.7)) },
        ],
    };
    let yaw = match number % 4 {
        1 => line(pace),
        _ => wave(near(0.9), near(0.9)),
    };
    let (pitch, roll) = (wave(near(0.25), near(1.3)), wave(near(0.3), near(1.7)));
    Trajectory { position, angles: EulerAngles { yaw, pitch, roll }, ..Trajectory::default() }
}

fn bias(draws: &mut Draws) -> ImuBias {
    let mut of = |sigma: f64| Vector3::from_fn(|_, _| sigma * draws.normal());
    ImuBias { gyro: of(BIASES[0]), accelerometer: of(BIASES[1]) }
}

/// The camera with a lever arm, and turned a little.
fn mounted(ahead: &Isometry3<f64>, draws: &mut Draws) -> Isometry3<f64> {
    let mut of = |size: f64| Vector3::from_fn(|_, _| draws.between(-size, size));
    let (lever, turn) = (Vector3::new(0.1, 0.05, -0.02) + of(0.03), of(0.2));
    let turn = Rotation3::new(turn) * ahead.rotation.to_rotation_matrix();
    Isometry3::from_parts(Translation3::from(lever), turn.into())
}
