//! A visual-inertial window, put together from the library's parts.
//!
//! ```text
//! cargo run --release -p vislam --example window
//! ```
//!
//! A simulated flight of ten pictures. Unknown are the states of the body and its biases, the
//! landmarks, where the camera sits on the body, how late its clock is, and where down is. The
//! program says what is free, solves, says how sure the estimate is, holds a linearization point,
//! and takes the oldest state out. [`Sensors`] is where a recording of your own goes in.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::Range;

use nalgebra::{DVector, Isometry3, Vector1, Vector2, Vector3};
use vislam::datasets::tracks::Picture;
use vislam::factors::{CombinedInertialFactor, PixelByBody, Prior};
use vislam::inertial::{
    CameraImu, GRAVITY, Gravity, ImuBias, ImuNoise, NavState, StampedSample, WindowError, between,
};
use vislam::least_squares::{
    Covariance, Fronts, Kernel, Key, LandmarkElimination, Manifold, NullSpace, Options, Problem,
    Solution, SolveError, Values,
};
use vislam::manifold::so3;
use vislam::preintegration::preintegrate_combined;
use vislam::reprojection::Pinhole;
use vislam::simulation::{Flight, FlightError, FlightRecording, Trajectory};
use vislam::two_views::{View, triangulate};

// ANCHOR: sensors
/// What was recorded, and what is known of the sensors.
pub struct Sensors<'a> {
    pub readings: &'a [StampedSample],
    pub pictures: &'a [Picture],
    pub camera: Pinhole,
    pub noise: ImuNoise,
    pub pixel_sigma: f64,
}
// ANCHOR_END: sensors

// ANCHOR: window
/// The unknowns of a window, and what has been measured of them.
pub struct Window {
    pub problem: Problem,
    /// By picture.
    pub states: Vec<Key<NavState>>,
    pub biases: Vec<Key<ImuBias>>,
    /// By track.
    pub landmarks: BTreeMap<usize, Key<Vector3<f64>>>,
    pub extrinsics: Key<Isometry3<f64>>,
    pub time_offset: Key<Vector1<f64>>,
    pub gravity: Key<Gravity>,
}
// ANCHOR_END: window

/// What is known beforehand.
pub struct Known {
    pub state: NavState,
    pub bias: ImuBias,
    pub rig: CameraImu,
}

// ANCHOR: sigmas
/// The standard deviations of what is known: turns, velocity and position, in rad, m/s and m; the
/// biases of gyroscope and accelerometer, in rad/s and m/s²; shifts and turns of the camera on the
/// body, in m and rad; and the camera's clock, in s.
pub const STATE: [f64; 9] = [0.002, 0.002, 0.002, 0.1, 0.1, 0.1, 0.01, 0.01, 0.01];
pub const BIAS: [f64; 6] = [0.01, 0.01, 0.01, 0.1, 0.1, 0.1];
pub const EXTRINSICS: [f64; 6] = [0.02, 0.02, 0.02, 0.01, 0.01, 0.01];
pub const TIME_OFFSET: [f64; 1] = [0.01];
// ANCHOR_END: sigmas

/// Rays that meet at a smaller angle than this, in rad, make no landmark.
const PARALLAX: f64 = 0.08;

impl<'a> From<&'a FlightRecording> for Sensors<'a> {
    fn from(FlightRecording { flight, readings, pictures, .. }: &'a FlightRecording) -> Self {
        let Flight { camera, noise, pixel_sigma, .. } = *flight;
        Self { readings, pictures, camera, noise, pixel_sigma }
    }
}

impl Window {
    // ANCHOR: new
    /// A window of all pictures, with a guess of the state at each.
    pub fn new(
        sensors: &Sensors,
        guess: &[NavState],
        known: &Known,
    ) -> Result<Self, Box<dyn Error>> {
        if guess.len() != sensors.pictures.len() {
            return Err("give one guess of a state for each picture".into());
        }
        let mut problem = Problem::new();
        let mut window = Self {
            states: guess.iter().map(|state| problem.add_variable(*state)).collect(),
            biases: guess.iter().map(|_| problem.add_variable(known.bias)).collect(),
            landmarks: BTreeMap::new(),
            extrinsics: problem.add_variable(known.rig.body_from_camera),
            time_offset: problem.add_variable(Vector1::new(known.rig.time_offset)),
            gravity: problem.add_variable(Gravity(GRAVITY)),
            problem,
        };
        let turning = window.add_readings(sensors, &known.bias)?;
        window.add_pixels(sensors, &turning)?;
        Ok(window)
    }
    // ANCHOR_END: new

    // ANCHOR: readings
    /// What the readings between the pictures say. Returns the angular velocity at each picture.
    fn add_readings(
        &mut self,
        sensors: &Sensors,
        bias: &ImuBias,
    ) -> Result<Vec<Vector3<f64>>, Box<dyn Error>> {
        let mut turning = Vec::new();
        for (k, readings) in intervals(sensors)?.iter().enumerate() {
            let sums = preintegrate_combined(readings, bias, &sensors.noise)?;
            let states = [self.states[k], self.states[k + 1]];
            let biases = [self.biases[k], self.biases[k + 1]];
            let factor = CombinedInertialFactor::new(states, biases, self.gravity, &sums)?;
            self.problem.add_factor(factor, Kernel::Squared)?;
            let ends = [readings.first().filter(|_| k == 0), readings.last()];
            turning.extend(ends.into_iter().flatten().map(|end| end.sample.corrected(bias).gyro));
        }
        Ok(turning)
    }
    // ANCHOR_END: readings

    /// A landmark for each track of three pictures or more, where the predicted states see it, and
    /// a factor for each of its pixels.
    fn add_pixels(
        &mut self,
        sensors: &Sensors,
        turning: &[Vector3<f64>],
    ) -> Result<(), Box<dyn Error>> {
        // ANCHOR: pixels
        for (track, seen) in tracks(sensors).iter().filter(|(_, seen)| seen.len() >= 3) {
            let views: Vec<View> =
                seen.iter().map(|(k, pixel)| self.view(sensors, *k, *pixel)).collect();
            let Ok(place) = triangulate(&views, PARALLAX) else { continue };
            let landmark = self.problem.add_variable(place);
            self.landmarks.insert(*track, landmark);
            for &(k, pixel) in seen {
                let factor = PixelByBody {
                    state: self.states[k],
                    landmark,
                    extrinsics: self.extrinsics,
                    time_offset: self.time_offset,
                    camera: sensors.camera,
                    angular_velocity: turning[k],
                    pixel,
                    inverse_sigma: 1.0 / sensors.pixel_sigma,
                };
                self.problem.add_factor(factor, Kernel::Squared)?;
            }
        }
        // ANCHOR_END: pixels
        Ok(())
    }

    /// What the camera saw from a state as it stands now.
    fn view(&self, sensors: &Sensors, picture: usize, pixel: Vector2<f64>) -> View {
        let values = self.problem.values();
        let rig = CameraImu { body_from_camera: values[self.extrinsics], time_offset: 0.0 };
        let camera_from_world = rig.camera_from_world(&values[self.states[picture]]);
        View { camera: sensors.camera, camera_from_world, pixel, sigma: sensors.pixel_sigma }
    }

    // ANCHOR: priors
    /// Adds what is known beforehand.
    pub fn add_priors(&mut self, known: &Known) -> Result<(), Box<dyn Error>> {
        let (problem, CameraImu { body_from_camera, time_offset }) = (&mut self.problem, known.rig);
        let offset = Prior::near(self.time_offset, Vector1::new(time_offset), TIME_OFFSET);
        let extrinsics = Prior::near(self.extrinsics, body_from_camera, EXTRINSICS);
        problem.add_factor(Prior::near(self.states[0], known.state, STATE), Kernel::Squared)?;
        problem.add_factor(Prior::near(self.biases[0], known.bias, BIAS), Kernel::Squared)?;
        problem.add_factor(extrinsics, Kernel::Squared)?;
        problem.add_factor(offset, Kernel::Squared)?;
        Ok(())
    }
    // ANCHOR_END: priors

    // ANCHOR: tiles
    /// By picture the state and its biases, by number.
    pub fn tiles(&self) -> Vec<Vec<usize>> {
        let pairs = self.states.iter().zip(&self.biases);
        pairs.map(|(state, bias)| vec![state.index(), bias.index()]).collect()
    }

    /// A linear system that eliminates the landmarks first, one by one. Each state shares a row of
    /// 15×15 blocks with its biases, and a pixel sees the first 9 coordinates of a row.
    pub fn landmarks_first(&self) -> Result<LandmarkElimination<15, 9>, SolveError> {
        LandmarkElimination::in_tiles::<Vector3<f64>>(&self.problem, &self.tiles())
    }
    // ANCHOR_END: tiles

    // ANCHOR: take_out
    /// Takes out the oldest state and its bias, keeps the information of their factors as a prior, and
    /// freezes the linearization points of the variables in it, unless an earlier prior froze them.
    pub fn take_out_oldest(&mut self, values: &Values) -> Result<Vec<usize>, Box<dyn Error>> {
        let oldest = [self.states.remove(0).index(), self.biases.remove(0).index()];
        let named = self.problem.marginalize(values, &oldest)?;
        self.problem.freeze_priors();
        Ok(named)
    }
    // ANCHOR_END: take_out

    // ANCHOR: moved
    /// The window moved as a whole: turned about the origin by a rotation vector, then shifted.
    fn moved(&self, turn: Vector3<f64>, shift: Vector3<f64>) -> Values {
        let (rotation, mut values) = (so3::exp(&turn), self.problem.values().clone());
        for &key in &self.states {
            let NavState { world_from_body, velocity, position } = values[key];
            let world_from_body = rotation * world_from_body;
            let (velocity, position) = (rotation * velocity, rotation * position + shift);
            values.set(key, NavState { world_from_body, velocity, position });
        }
        for &key in self.landmarks.values() {
            values.set(key, rotation * values[key] + shift);
        }
        values.set(self.gravity, Gravity(rotation * values[self.gravity].0));
        values
    }
    // ANCHOR_END: moved

    // ANCHOR: free
    /// The motions of the whole window that no measurement notices, and how many directions are
    /// free in all.
    pub fn free(&self) -> Result<(usize, Vec<&'static str>), Box<dyn Error>> {
        let (problem, values) = (&self.problem, self.problem.values());
        let (null_space, columns) = (problem.null_space(values)?, problem.columns());
        let is_free = |turn, shift| {
            let step = values.local(&self.moved(turn, shift));
            let moving = step.iter().zip(&columns.of).filter(|(_, column)| column.is_some());
            let direction = DVector::from_iterator(columns.count, moving.map(|(step, _)| *step));
            null_space.leaves(&direction) < NullSpace::TOLERANCE
        };
        let named = MOTIONS.iter().filter(|(_, turn, shift)| is_free(1e-6 * turn, 1e-6 * shift));
        Ok((null_space.nullity(), named.map(|(name, ..)| *name).collect()))
    }
    // ANCHOR_END: free
}

/// Turns and shifts by one.
const MOTIONS: [(&str, Vector3<f64>, Vector3<f64>); 6] = [
    ("shift along x", Vector3::new(0.0, 0.0, 0.0), Vector3::new(1.0, 0.0, 0.0)),
    ("shift along y", Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0)),
    ("shift along z", Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0)),
    ("turn about x", Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.0)),
    ("turn about y", Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 0.0)),
    ("turn about z", Vector3::new(0.0, 0.0, 1.0), Vector3::new(0.0, 0.0, 0.0)),
];

/// By track, the pictures that show it and the pixels at which they do.
pub fn tracks(sensors: &Sensors) -> BTreeMap<usize, Vec<(usize, Vector2<f64>)>> {
    let mut tracks: BTreeMap<usize, Vec<(usize, Vector2<f64>)>> = BTreeMap::new();
    for (k, picture) in sensors.pictures.iter().enumerate() {
        for feature in &picture.features {
            tracks.entry(feature.track).or_default().push((k, feature.pixel));
        }
    }
    tracks
}

/// The readings from each picture to the next, by the time on the camera's clock.
pub fn intervals(sensors: &Sensors) -> Result<Vec<Vec<StampedSample>>, WindowError> {
    let pairs = sensors.pictures.windows(2);
    pairs.map(|p| between(sensors.readings, p[0].nanoseconds, p[1].nanoseconds)).collect()
}

// ANCHOR: predicted
/// The state at each picture, each from the one before it by the readings alone.
pub fn predicted(sensors: &Sensors, known: &Known) -> Result<Vec<NavState>, WindowError> {
    let (mut state, mut states) = (known.state, vec![known.state]);
    for readings in intervals(sensors)? {
        for pair in readings.windows(2) {
            let [from, to] = [&pair[0], &pair[1]].map(|end| end.sample.corrected(&known.bias));
            state = state.propagate_midpoint(&from, &to, &GRAVITY, pair[0].seconds_to(&pair[1]));
        }
        states.push(state);
    }
    Ok(states)
}
// ANCHOR_END: predicted

// ANCHOR: flight
/// A flight whose camera is late by eight milliseconds, with four pictures a second.
pub fn record(
    seconds: f64,
    tracks: usize,
    landmarks: usize,
    seed: u64,
) -> Result<FlightRecording, FlightError> {
    let motion = Trajectory::figure_eight();
    let flight = Flight { seconds, picture_rate: 4.0, tracks, ..Flight::new(motion) };
    let mut flight = flight.with_lever(Vector3::new(0.1, 0.05, -0.02));
    flight.rig.time_offset = 0.008;
    let mut recording = flight.record(&flight.room(2.0, landmarks, seed)?, seed)?;
    // On a clock that is late, the first picture comes before the first reading.
    recording.pictures.remove(0);
    Ok(recording)
}
// ANCHOR_END: flight

/// A window of ten pictures without priors, and what is known beforehand: the truth half a standard
/// deviation off.
pub fn without_priors() -> Result<(FlightRecording, Known, Window), Box<dyn Error>> {
    let recording = record(2.5, 220, 1100, 1)?;
    let (rig, truth) = (recording.flight.rig, &recording.truth);
    // The window's states stand where the sensor's clock shows what the camera's does at a picture.
    let time = 1e-9 * recording.pictures[0].nanoseconds as f64;
    let first = recording.flight.motion.at(time).state;
    let known = Known {
        state: near_to(&first, &STATE),
        bias: near_to(&truth.biases[1], &BIAS),
        rig: CameraImu {
            body_from_camera: near_to(&rig.body_from_camera, &EXTRINSICS),
            time_offset: 0.0,
        },
    };
    let sensors = Sensors::from(&recording);
    let window = Window::new(&sensors, &predicted(&sensors, &known)?, &known)?;
    Ok((recording, known, window))
}

/// A value half a standard deviation off.
fn near_to<V: Manifold>(value: &V, sigmas: &[f64]) -> V {
    value.retract(&sigmas.iter().map(|sigma| 0.5 * sigma).collect::<Vec<_>>())
}

// ANCHOR: solve
/// Solves with the variables eliminated in an order that fills in little.
pub fn solve(problem: &Problem) -> Result<Solution, SolveError> {
    problem.solve_with(Fronts::new(problem)?, &Options::default())
}
// ANCHOR_END: solve

// ANCHOR: errors
/// How far estimates are from the truth, and what their covariances say of that.
fn print_errors(
    window: &Window,
    values: &Values,
    flight: &Flight,
    seconds: f64,
) -> Result<(), SolveError> {
    let covariance = window.problem.covariance_with(Fronts::new(&window.problem)?, values)?;
    let last = window.states[window.states.len() - 1];
    let (truth, rig) = (flight.motion.at(seconds).state, flight.rig);
    let late = Vector1::new(rig.time_offset);
    print("last position", 6..9, "mm", (last, &truth), values, &covariance);
    print(
        "camera on the body",
        0..3,
        "mm",
        (window.extrinsics, &rig.body_from_camera),
        values,
        &covariance,
    );
    print("camera's clock", 0..1, "ms", (window.time_offset, &late), values, &covariance);
    print("down", 0..2, "mrad", (window.gravity, &Gravity(GRAVITY)), values, &covariance);
    Ok(())
}

/// Prints how far an estimate is off, in thousandths.
fn print<V: Manifold>(
    what: &str,
    coordinates: Range<usize>,
    unit: &str,
    estimated: (Key<V>, &V),
    values: &Values,
    covariance: &Covariance,
) {
    let (off, sigma) = compare(estimated, values, covariance, coordinates);
    println!("  {what}: {:.2} {unit} off, {:.2} expected", 1e3 * off, 1e3 * sigma);
}

/// The length of some coordinates of the step from the truth to an estimate, and the root of the sum
/// of their variances.
pub fn compare<V: Manifold>(
    (key, truth): (Key<V>, &V),
    values: &Values,
    covariance: &Covariance,
    coordinates: Range<usize>,
) -> (f64, f64) {
    let mut step = vec![0.0; truth.dimension()];
    truth.local(&values[key], &mut step);
    let off = coordinates.clone().map(|at| step[at] * step[at]).sum::<f64>();
    let variances = covariance.of(key).map(|matrix| coordinates.map(|at| matrix[(at, at)]).sum());
    (off.sqrt(), variances.unwrap_or(f64::NAN).sqrt())
}
// ANCHOR_END: errors

fn main() -> Result<(), Box<dyn Error>> {
    let (recording, known, mut window) = without_priors()?;
    let (free, named) = window.free()?;
    println!("without priors {free} directions are free: {}", named.join(", "));

    window.add_priors(&known)?;
    let along = Fronts::order_along(&window.problem, &window.tiles().concat())?;
    let products = |fronts: Fronts| 1e-6 * fronts.products() as f64;
    println!(
        "an elimination takes {:.1} million products, along the flight {:.1}",
        products(Fronts::new(&window.problem)?),
        products(Fronts::in_order(&window.problem, &along)?)
    );
    let Solution { values, report } = solve(&window.problem)?;
    println!("{}: {} steps, 2F = {:.0}", report.stop, report.iterations.len(), 2.0 * report.cost);
    let seconds = 1e-9 * recording.pictures[9].nanoseconds as f64;
    print_errors(&window, &values, &recording.flight, seconds)?;

    let named = window.take_out_oldest(&values)?.len();
    println!("without the oldest state, of which {named} variables keep what was said:");
    print_errors(&window, &solve(&window.problem)?.values, &recording.flight, seconds)?;
    Ok(())
}
