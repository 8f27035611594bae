//! Flies simulated flights with the multi-state constraint Kalman filter, and says whether its errors
//! are as large as it believes.
//!
//! ```text
//! cargo run --release -p vislam --example filter -- \
//!     [--flights N] [--minutes M] [--seed S] [--first-estimates] [--kept N]
//! ```
//!
//! A flight has 200 readings and ten pictures a second, with up to 40 tracks of one pixel's noise
//! each. The filter keeps eleven poses; `--kept` landmarks stay in its state as long as they are
//! seen. The last line has the mean over all flights of the normalized errors squared at the end,
//! each divided by its dimension, the root mean square of the position errors at all pictures, in
//! centimetres and without alignment, and the time that a picture took with its readings.

use std::error::Error;
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use vislam::consistency::Policy;
use vislam::filtering::BlockNees;
use vislam::msckf::{Msckf, MsckfError, MsckfOptions, PictureReport, Start};
use vislam::simulation::{Flight, FlightError, FlightRecording, Trajectory};

const USAGE: &str =
    "usage: filter [--flights N] [--minutes M] [--seed S] [--first-estimates] [--kept N]";

// ANCHOR: sigmas
/// The standard deviations of what is known at the beginning: turns, velocity and position, in rad,
/// m/s and m, and the biases of gyroscope and accelerometer, in rad/s and m/s².
pub const SIGMAS: [f64; 15] =
    [0.01, 0.01, 1e-3, 0.05, 0.05, 0.05, 1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3, 0.02, 0.02, 0.02];
// ANCHOR_END: sigmas

const LANDMARKS: usize = 800;

// ANCHOR: flight
/// A flight in a room, and what its sensors bring home.
pub fn flown(flight: &Flight, seed: u64) -> Result<FlightRecording, FlightError> {
    flight.record(&flight.room(3.0, LANDMARKS, seed)?, seed)
}

/// The flight of the example.
pub fn flight(seconds: f64) -> Flight {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let motion = Trajectory::figure_eight();
    Flight { seconds, picture_rate: 10.0, tracks: 40, ..Flight::new(motion).with_lever(lever) }
}
// ANCHOR_END: flight

// ANCHOR: start
/// What is believed at the beginning: the truth, off by an error that is drawn.
pub fn start(recording: &FlightRecording, seed: u64) -> Start {
    Start::drawn(recording, &SIGMAS, 1000 + seed).expect("a recording has a picture")
}
// ANCHOR_END: start

// ANCHOR: fly
/// Gives a filter the readings and pictures of a recording, and visits it after each picture.
pub fn fly(
    recording: &FlightRecording,
    options: MsckfOptions,
    start: &Start,
    mut visit: impl FnMut(usize, &Msckf, &PictureReport),
) -> Result<Msckf, MsckfError> {
    let mut filter = Msckf::new(options, start)?;
    let mut number = 0;
    while let Some(report) = filter.follow(recording, number)? {
        visit(number, &filter, &report);
        number += 1;
    }
    Ok(filter)
}
// ANCHOR_END: fly

/// What the flights add up to.
#[derive(Default)]
struct Sums {
    nees: [f64; 4],
    squares: f64,
    pictures: usize,
    time: Duration,
}

impl Sums {
    fn add(&mut self, arguments: &Arguments, seed: u64) -> Result<(), Box<dyn Error>> {
        let recording = flown(&flight(60.0 * arguments.minutes), seed)?;
        let policy = match arguments.first_estimates {
            true => Policy::FirstEstimates,
            false => Policy::Standard,
        };
        let options = MsckfOptions {
            linearization: policy.into(),
            landmarks: arguments.kept,
            ..MsckfOptions::of_flight(&recording.flight)
        };
        let states = &recording.truth.states;
        let begin = Instant::now();
        let filter = fly(&recording, options, &start(&recording, seed), |number, filter, _| {
            self.squares += (states[number].position - filter.state().position).norm_squared();
        })?;
        self.time += begin.elapsed();
        self.pictures += states.len();
        let covariance = filter.covariance().fixed_view::<9, 9>(0, 0).into_owned();
        let truth = states.last().ok_or("the flight has no picture")?;
        let BlockNees { position, tilt, yaw, velocity } =
            BlockNees::of(filter.state(), truth, &covariance)?;
        let all = [position, tilt, yaw, velocity];
        self.nees.iter_mut().zip(all).for_each(|(sum, nees)| *sum += nees);
        Ok(())
    }

    fn print(&self, flights: u64) {
        let [position, tilt, yaw, velocity] = self.nees.map(|sum| sum / flights as f64);
        let rmse = 100.0 * (self.squares / self.pictures as f64).sqrt();
        let time = 1e3 * self.time.as_secs_f64() / self.pictures as f64;
        println!("nees_velocity {velocity:.2}");
        println!(
            "nees_position {position:.2}  nees_tilt {tilt:.2}  nees_yaw {yaw:.2}  rmse_cm \
             {rmse:.2}  ms_per_picture {time:.3}"
        );
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::read(std::env::args().skip(1))?;
    let mut sums = Sums::default();
    for flight in 0..arguments.flights {
        sums.add(&arguments, arguments.seed + flight)?;
    }
    sums.print(arguments.flights);
    Ok(())
}

struct Arguments {
    flights: u64,
    minutes: f64,
    seed: u64,
    kept: usize,
    first_estimates: bool,
}

impl Arguments {
    fn read(mut given: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut read = Self { flights: 10, minutes: 1.0, seed: 0, kept: 0, first_estimates: false };
        while let Some(name) = given.next() {
            let mut value = || given.next().ok_or(format!("{name} needs a value; {USAGE}"));
            match name.as_str() {
                "--flights" => read.flights = number(&name, &value()?)?,
                "--minutes" => read.minutes = number(&name, &value()?)?,
                "--seed" => read.seed = number(&name, &value()?)?,
                "--kept" => read.kept = number(&name, &value()?)?,
                "--first-estimates" => read.first_estimates = true,
                _ => return Err(format!("unknown argument `{name}`; {USAGE}")),
            }
        }
        let holds = read.flights > 0 && read.minutes > 0.0 && read.minutes.is_finite();
        holds.then_some(read).ok_or(format!("give at least one flight, longer than zero; {USAGE}"))
    }
}

fn number<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{name} is `{text}`, which is no number that fits; {USAGE}"))
}
