//! Simulated flights, many of them: how soon each begins, and whether its errors are as large as it
//! says.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use vislam::datasets::tracks::Picture;
use vislam::filtering::chi_square_band;
use vislam::inertial::ImuBias;
use vislam::initialization::{
    AlignmentRefused, BeginOptions, MotionOptions, NoStart, Sensors, Started, UniformMotion, begin,
    in_motion,
};
use vislam::simulation::{
    EulerAngles, Flight, FlightRecording, ScalarTrajectory, Trajectory, landmarks_around,
};

use super::judged::{Judged, Tilt};
use crate::chapter::Chapter;
use crate::random::Random;
use crate::record::RecordValue;
use crate::statistics::median;

const FLIGHTS: u64 = 100;
const LIVE: u64 = 5;
/// Of each motion that hides its scale.
const UNIFORM: u64 = 20;
const LEVER: Vector3<f64> = Vector3::new(0.1, 0.05, -0.02);
/// Standard deviations of the biases on each axis, in rad/s and m/s².
const BIASES: [f64; 2] = [0.05, 0.05];
const RATE: f64 = 10.0;
const TRACKS: usize = 60;
const PIXEL: f64 = 0.5;
/// Seconds within which a flight should have begun.
const SOON: f64 = 2.0;
/// A sum of normalized errors lies outside its band with this probability.
const OUTSIDE: f64 = 0.003;
/// Seconds after which a start is tried, and the share that is refused.
const REFUSED: [(f64, &str); 5] = [
    (0.5, "refused_05"),
    (1.0, "refused_10"),
    (1.5, "refused_15"),
    (2.0, "refused_20"),
    (3.0, "refused_30"),
];
/// Flights that the figure follows, and the seconds at which it does.
pub const FOLLOWED: u64 = 4;
pub const TIMES: [f64; 8] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let motion = "Trajectory::figure_eight(), amplitudes by 0.75 to 1, any phases";
    let inputs = vec![
        ("seeds", format!("0 to {}", FLIGHTS - 1)),
        ("motion", motion.to_owned()),
        ("pictures", format!("{RATE} a second, {TRACKS} tracks, {PIXEL} px")),
        ("biases", format!("{} rad/s and {} m/s² on each axis", BIASES[0], BIASES[1])),
        ("noise", "ImuNoise::euroc()".to_owned()),
        ("uniform motions", format!("{UNIFORM} flights each")),
    ];
    chapter.record("initial_flights", inputs, flights);
}

pub fn numbers(chapter: &mut Chapter) {
    let flights: Vec<FlightRecording> = (0..LIVE).map(|seed| eight(seed, SOON)).collect();
    let begun = flights.iter().filter_map(Begun::of).count();
    let found = flights.iter().filter_map(|recording| {
        let started = started(recording, SOON, &options()).ok()?;
        Some(judged(recording, &started))
    });
    let found: Vec<Judged> = found.collect();
    let scale = found.iter().map(|judged| judged.scale.abs()).fold(0.0, f64::max);
    let tilt = found.iter().map(|judged| judged.tilt.degrees()).fold(0.0, f64::max);
    chapter.number("flown_gyro_bias", BIASES[0], "rad/s", 2);
    chapter.number("flown_accelerometer_bias", BIASES[1], "m/s²", 2);
    chapter.number("live_flights", LIVE as f64, "", 0);
    chapter.number("live_begun", begun as f64, "", 0);
    chapter.number("live_scale_most", 100.0 * scale, "%", 1);
    chapter.number("live_tilt_most", tilt, "°", 2);
}

/// Sensors on a motion, with biases that are drawn.
fn flight(motion: Trajectory, seconds: f64, seed: u64) -> Flight {
    let mut random = Random::new(seed);
    let mut drawn = |sigma| Vector3::from_fn(|_, _| random.normal(sigma));
    let [gyro, accelerometer] = BIASES.map(&mut drawn);
    let initial_bias = ImuBias { gyro, accelerometer };
    let flight = Flight { seconds, picture_rate: RATE, tracks: TRACKS, ..Flight::new(motion) };
    Flight { initial_bias, pixel_sigma: PIXEL, ..flight.with_lever(LEVER) }
}

fn recorded(flight: &Flight, landmarks: &[Vector3<f64>], seed: u64) -> FlightRecording {
    flight.record(landmarks, seed).expect("it can be flown")
}

/// A figure-eight, smaller by up to a quarter on each axis and taken up anywhere.
pub fn eight(seed: u64, seconds: f64) -> FlightRecording {
    let mut random = Random::new(seed + 1000);
    let Trajectory { mut position, angles: EulerAngles { mut yaw, mut pitch, mut roll }, .. } =
        Trajectory::figure_eight();
    for coordinate in position.iter_mut().chain([&mut yaw, &mut pitch, &mut roll]) {
        coordinate.amplitude *= random.uniform(0.75..1.0);
        coordinate.phase = random.uniform(0.0..TAU);
    }
    let motion =
        Trajectory { position, angles: EulerAngles { yaw, pitch, roll }, ..Trajectory::default() };
    let flight = flight(motion, seconds, seed);
    let landmarks = flight.room(3.0, 400, seed).expect("a room");
    recorded(&flight, &landmarks, seed)
}

/// The pictures of the first seconds.
pub fn first(pictures: &[Picture], seconds: f64) -> &[Picture] {
    let until = |from: i64| from.saturating_add((1e9 * seconds).round() as i64 + 1000);
    let end = pictures.first().map_or(0, |first| until(first.nanoseconds));
    &pictures[..pictures.partition_point(|picture| picture.nanoseconds <= end)]
}

/// Every so manieth picture is used by a start in motion: five a second, as [`begin`] does.
pub const THINNED: usize = 2;

/// A start in motion from the first seconds of a flight.
pub fn started(
    recording: &FlightRecording,
    seconds: f64,
    options: &MotionOptions,
) -> Result<Started, NoStart> {
    let pictures = first(&recording.pictures, seconds).iter().step_by(THINNED);
    let pictures: Vec<Picture> = pictures.cloned().collect();
    in_motion(&Sensors::of_flight(&recording.flight), &recording.readings, &pictures, options)
}

/// The options of a start that say how the biases are drawn.
fn options() -> MotionOptions {
    let [gyro_bias, accelerometer_bias] = BIASES;
    MotionOptions { gyro_bias, accelerometer_bias, ..MotionOptions::default() }
}

/// Options that take every start, however uncertain.
pub fn any(options: MotionOptions) -> MotionOptions {
    let free = f64::INFINITY;
    MotionOptions { scale_sigma: free, tilt_sigma: free, ..options }
}

fn judged(recording: &FlightRecording, started: &Started) -> Judged {
    let truth = recording.truth.states.iter().step_by(THINNED);
    Judged::of(started, &truth.copied().collect::<Vec<_>>())
}

/// A flight that has begun.
struct Begun {
    seconds: f64,
    scale_sigma: f64,
    /// The error of the tilt of the first known state, in degrees.
    tilt: f64,
}

impl Begun {
    fn of(recording: &FlightRecording) -> Option<Self> {
        let pictures = first(&recording.pictures, SOON);
        let sensors = Sensors::of_flight(&recording.flight);
        let begun =
            begin(&sensors, &recording.readings, pictures, &BeginOptions::default()).ok()?;
        let truth = &recording.truth.states[begun.known.first];
        let tilt = Tilt::of(&begun.known.states[0].0, truth, &nalgebra::Matrix3::identity());
        let (seconds, scale_sigma) = (begun.seconds, begun.scale_sigma?);
        Some(Self { seconds, scale_sigma, tilt: tilt.degrees() })
    }
}

fn value(
    name: impl Into<std::borrow::Cow<'static, str>>,
    value: f64,
    unit: &'static str,
    decimals: usize,
) -> RecordValue {
    RecordValue::new(name, value, unit, decimals, 1e-3)
}

fn flights() -> Vec<RecordValue> {
    let mut values = vec![value("flights", FLIGHTS as f64, "", 0)];
    let (mut begun, mut found, mut refused) = (Vec::new(), Vec::new(), [0.0; REFUSED.len()]);
    for recording in (0..FLIGHTS).map(|seed| eight(seed, 3.0)) {
        begun.extend(Begun::of(&recording));
        for (count, (seconds, _)) in refused.iter_mut().zip(REFUSED) {
            match started(&recording, seconds, &options()) {
                Err(_) => *count += 1.0,
                Ok(started) if seconds == SOON => found.push(judged(&recording, &started)),
                Ok(_) => {}
            }
        }
    }
    values.extend(beginnings(&begun));
    values.extend(normalized(&found));
    let share = |count: f64| 100.0 * count / FLIGHTS as f64;
    let shares = REFUSED.iter().zip(refused);
    values.extend(shares.map(|((_, name), count)| value(*name, share(count), "%", 0)));
    values.extend(uniform());
    values.extend(followed());
    values
}

fn beginnings(begun: &[Begun]) -> Vec<RecordValue> {
    let of = |number: fn(&Begun) -> f64| begun.iter().map(number);
    vec![
        value("begun", begun.len() as f64, "", 0),
        value("seconds_median", median(of(|begun| begun.seconds)), "s", 1),
        value("begun_sigma_median", 100.0 * median(of(|begun| begun.scale_sigma)), "%", 1),
        value("begun_tilt_median", median(of(|begun| begun.tilt)), "°", 2),
        value("begun_tilt_most", of(|begun| begun.tilt).fold(0.0, f64::max), "°", 2),
    ]
}

fn normalized(judged: &[Judged]) -> Vec<RecordValue> {
    let scales = judged.iter().map(|judged| (judged.scale / judged.scale_sigma).powi(2));
    let band = |degrees| chi_square_band(OUTSIDE, degrees).expect("a probability");
    let ([scale_low, scale_high], [tilt_low, tilt_high]) =
        (band(judged.len()), band(2 * judged.len()));
    let of = |number: fn(&Judged) -> f64| judged.iter().map(number);
    let good = |judged: &&Judged| judged.scale_sigma < 0.1 && judged.tilt.degrees() < 1.0;
    vec![
        value("good", judged.iter().filter(good).count() as f64, "", 0),
        value("accepted", judged.len() as f64, "", 0),
        value("scale_median", 100.0 * median(of(|judged| judged.scale.abs())), "%", 1),
        value("scale_sigma_median", 100.0 * median(of(|judged| judged.scale_sigma)), "%", 1),
        value("tilt_median", median(of(|judged| judged.tilt.degrees())), "°", 2),
        value("tilt_sigma_median", median(of(|judged| judged.tilt.sigma().to_degrees())), "°", 2),
        value("tilt_most", of(|judged| judged.tilt.degrees()).fold(0.0, f64::max), "°", 2),
        value("scale_sum", scales.sum(), "", 0),
        value("scale_low", scale_low, "", 0),
        value("scale_high", scale_high, "", 0),
        value("tilt_sum", of(|judged| judged.tilt.squared()).sum(), "", 0),
        value("tilt_low", tilt_low, "", 0),
        value("tilt_high", tilt_high, "", 0),
    ]
}

/// Motions that hide their scale.
#[derive(Clone, Copy, PartialEq)]
pub enum Hidden {
    Velocity,
    /// A level constant acceleration.
    Level,
    /// One that rises, so that a second scale fits as well.
    Rising,
    Hover,
}

impl Hidden {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Velocity, "named_velocity"),
        (Self::Level, "named_acceleration"),
        (Self::Rising, "named_rising"),
        (Self::Hover, "named_hover"),
    ];

    pub fn motion(self, random: &mut Random) -> Trajectory {
        let constant = |random: &mut Random| ScalarTrajectory::constant(random.uniform(-0.3..0.3));
        let angles =
            EulerAngles { yaw: constant(random), pitch: constant(random), roll: constant(random) };
        let velocity = random.direction(1.0);
        let velocity = random.uniform(0.5..1.5) * velocity;
        let mut motion = Trajectory::constant_velocity(&velocity, angles);
        let level = Vector3::new(random.normal(1.0), random.normal(1.0), 0.0).normalize();
        let level = random.uniform(0.3..0.8) * level;
        let acceleration = match self {
            Self::Velocity => Vector3::zeros(),
            Self::Level => level,
            Self::Rising => level + random.uniform(0.5..1.0) * Vector3::z(),
            Self::Hover => return Trajectory { angles, ..Trajectory::hover() },
        };
        for (coordinate, acceleration) in motion.position.iter_mut().zip(&acceleration) {
            coordinate.acceleration = *acceleration;
        }
        motion
    }

    /// Whether a refusal names this motion.
    fn is_named(self, refused: &NoStart) -> bool {
        use UniformMotion::{ConstantAcceleration, ConstantVelocity};
        let motion = match refused {
            NoStart::Uniform { motion, .. } => Some(*motion),
            _ => None,
        };
        match self {
            Self::Velocity => motion == Some(ConstantVelocity),
            Self::Level => motion == Some(ConstantAcceleration),
            Self::Rising => motion == Some(ConstantAcceleration) || fits_two_scales(refused),
            Self::Hover => matches!(refused, NoStart::Hover { .. }),
        }
    }
}

fn fits_two_scales(refused: &NoStart) -> bool {
    matches!(refused, NoStart::Alignment(AlignmentRefused::TwoScales { .. }))
}

fn uniform() -> Vec<RecordValue> {
    let mut values = vec![value("uniform_flights", UNIFORM as f64, "", 0)];
    let mut begun = 0.0;
    for (hidden, name) in Hidden::ALL {
        let mut named = 0.0;
        for seed in 0..UNIFORM {
            let motion = hidden.motion(&mut Random::new(seed + 2000));
            // Of a wall alone no two pictures make a beginning, so there is none here.
            let landmarks = landmarks_around(&Vector3::zeros(), 400);
            let recording = recorded(&flight(motion, SOON, seed), &landmarks, seed);
            match started(&recording, SOON, &options()) {
                Err(refused) if hidden.is_named(&refused) => named += 1.0,
                Err(refused) => eprintln!("{name}, flight {seed}: {refused}"),
                Ok(found) => {
                    eprintln!("{name}, flight {seed}: sigma {}", found.scale_sigma);
                    begun += 1.0;
                }
            }
        }
        values.push(value(name, named, "", 0));
    }
    values.push(value("begun_uniform", begun, "", 0));
    values
}

/// Error and standard deviation of the scale of some flights as they go on, in percent; both zero where
/// there is no start.
fn followed() -> Vec<RecordValue> {
    let mut values = Vec::new();
    for (number, recording) in (0..FOLLOWED).map(|seed| (seed, eight(seed, 5.0))) {
        for (at, seconds) in TIMES.into_iter().enumerate() {
            let found = started(&recording, seconds, &any(options()));
            let judged = found.map(|found| judged(&recording, &found));
            let [error, sigma] =
                judged.map_or([0.0; 2], |judged| [judged.scale, judged.scale_sigma]);
            values.push(value(format!("followed_{number}_{at}_error"), 100.0 * error, "%", 1));
            values.push(value(format!("followed_{number}_{at}_sigma"), 100.0 * sigma, "%", 1));
        }
    }
    values
}
