//! Flies the same simulated flights with the same filter, linearized in seven ways, and says whether
//! its errors are as large as it believes.
//!
//! ```text
//! cargo run --release -p vislam --example consistency -- \
//!     [--flights N] [--minutes M] [--seed S] [--policy NAME] \
//!     [--sensor euroc|mems] [--pixels SIGMA] [--longest-track N] [--clones N] [--kept N] [--perfect-start]
//! ```
//!
//! A flight has 200 readings and five pictures a second. All filters see the same pixels, none of
//! them wrong, and no gate is set. Position and yaw are known exactly at the beginning, as they are
//! what everything else is measured from; tilt, velocity and biases are off by what the filter is told
//! of them, with `--perfect-start` by a thousandth of it. For each policy a line has the
//! mean over all flights of the normalized errors squared at the end, each divided by its dimension,
//! the root mean square of the position errors at all pictures, in centimetres and without
//! alignment, the time that a picture took with its readings, and what the filter claimed to learn
//! about a turn of everything about the vertical, as a part of what its rows would say if nothing
//! cancelled.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use vislam::consistency::{Claimed, NoSuchPolicy, Policy};
use vislam::filtering::BlockNees;
use vislam::inertial::ImuNoise;
use vislam::msckf::{Msckf, MsckfError, MsckfOptions, PictureReport, Start};
use vislam::simulation::{Flight, FlightError, FlightRecording, Trajectory};

const USAGE: &str = "usage: consistency [--flights N] [--minutes M] [--seed S] [--policy NAME] \
                     [--sensor euroc|mems] [--pixels SIGMA] [--longest-track N] [--clones N] \
                     [--kept N] [--perfect-start]";

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

impl Setting {
    /// A good sensor, one pixel, tracks as long as they are seen, eleven poses, no kept landmarks,
    /// and a start as an initialization leaves it.
    pub fn new() -> Self {
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

// ANCHOR: flown
/// What the sensors of a flight in a room bring home.
pub fn flown(
    motion: Trajectory,
    setting: &Setting,
    seconds: f64,
    seed: u64,
) -> Result<FlightRecording, FlightError> {
    let Setting { noise, pixel_sigma, .. } = *setting;
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let new = Flight::new(motion).with_lever(lever);
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
    let start = Start::at_the_origin(recording, setting.start, 1000 + seed);
    let mut filter = Msckf::new(options, &start.ok_or(MsckfError::NoTruth { picture: 0 })?)?;
    let mut number = 0;
    while let Some(report) = filter.follow(recording, number)? {
        visit(number, &filter, &report);
        number += 1;
    }
    Ok(())
}
// ANCHOR_END: follow

/// What the flights of a policy add up to.
#[derive(Default)]
struct Sums {
    nees: [f64; 3],
    squares: f64,
    pictures: usize,
    time: Duration,
    claimed: Claimed,
}

impl Sums {
    fn add(
        &mut self,
        recording: &FlightRecording,
        (setting, policy): (&Setting, Policy),
        seed: u64,
    ) -> Result<(), Box<dyn Error>> {
        let states = &recording.truth.states;
        let begin = Instant::now();
        let mut last = None;
        follow(recording, setting, policy, seed, |number, filter, report| {
            self.squares += (states[number].position - filter.state().position).norm_squared();
            self.claimed.add(&report.claimed);
            let covariance = || filter.covariance().fixed_view::<9, 9>(0, 0).into_owned();
            if number + 1 == states.len() {
                last = Some(BlockNees::of(filter.state(), &states[number], &covariance()));
            }
        })?;
        self.time += begin.elapsed();
        self.pictures += states.len();
        let BlockNees { position, tilt, yaw, .. } = last.ok_or("the flight has no picture")??;
        self.nees.iter_mut().zip([position, tilt, yaw]).for_each(|(sum, nees)| *sum += nees);
        Ok(())
    }

    fn print(&self, policy: Policy, flights: u64) {
        let [position, tilt, yaw] = self.nees.map(|sum| sum / flights as f64);
        let rmse = 100.0 * (self.squares / self.pictures as f64).sqrt();
        let time = 1e3 * self.time.as_secs_f64() / self.pictures as f64;
        let Claimed { gained, whole } = self.claimed;
        let spurious = gained[3] / whole[3];
        println!(
            "policy {policy:<24}  nees_position {position:.2}  nees_tilt {tilt:.2}  nees_yaw \
             {yaw:.2}  rmse_cm {rmse:.2}  ms_per_picture {time:.3}  claimed_yaw {spurious:.1e}"
        );
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { flights, seconds, seed, policies, setting } =
        Arguments::read(std::env::args().skip(1))?;
    let mut sums: Vec<Sums> = policies.iter().map(|_| Sums::default()).collect();
    for seed in seed..seed + flights {
        let recording = flown(Trajectory::figure_eight(), &setting, seconds, seed)?;
        for (policy, sums) in policies.iter().zip(&mut sums) {
            sums.add(&recording, (&setting, *policy), seed)?;
        }
    }
    policies.iter().zip(&sums).for_each(|(policy, sums)| sums.print(*policy, flights));
    Ok(())
}

struct Arguments {
    flights: u64,
    seconds: f64,
    seed: u64,
    policies: Vec<Policy>,
    setting: Setting,
}

impl Arguments {
    fn read(mut given: impl Iterator<Item = String>) -> Result<Self, String> {
        let (mut flights, mut minutes, mut seed) = (10, 1.0, 0);
        let (mut policies, mut setting) = (Policy::ALL.to_vec(), Setting::new());
        while let Some(name) = given.next() {
            let mut value = || given.next().ok_or(format!("{name} needs a value; {USAGE}"));
            match name.as_str() {
                "--flights" => flights = number(&name, &value()?)?,
                "--minutes" => minutes = number(&name, &value()?)?,
                "--seed" => seed = number(&name, &value()?)?,
                "--pixels" => setting.pixel_sigma = number(&name, &value()?)?,
                "--longest-track" => setting.longest_track = number(&name, &value()?)?,
                "--clones" => setting.clones = number(&name, &value()?)?,
                "--kept" => setting.landmarks = number(&name, &value()?)?,
                "--perfect-start" => setting.start = PERFECT,
                "--policy" => {
                    let policy = value()?.parse().map_err(|error: NoSuchPolicy| error.to_string());
                    policies = vec![policy?];
                }
                "--sensor" => setting.noise = sensor(&value()?)?,
                _ => return Err(format!("unknown argument `{name}`; {USAGE}")),
            }
        }
        let is_long = minutes > 0.0 && minutes < 1e4;
        let holds = flights > 0 && is_long && setting.clones > 2 && setting.longest_track > 2;
        let seconds = 60.0 * minutes;
        holds.then_some(Self { flights, seconds, seed, policies, setting }).ok_or(format!(
            "give at least one flight, longer than zero minutes, and three or more pictures to \
             windows and tracks; {USAGE}"
        ))
    }
}

fn sensor(name: &str) -> Result<ImuNoise, String> {
    match name {
        "euroc" => Ok(ImuNoise::euroc()),
        "mems" => Ok(ImuNoise::mems()),
        _ => Err(format!("--sensor is `{name}`, and not euroc or mems; {USAGE}")),
    }
}

fn number<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{name} is `{text}`, which is no number that fits; {USAGE}"))
}
