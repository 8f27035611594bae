//! Two keyframes, the readings between them and six landmarks: the smallest visual-inertial graph, which
//! the book solves with its own library, with factrs and with GTSAM.
//!
//! ```text
//! cargo run --release -p vislam --example two_keyframes -- [SEED]
//! ```
//!
//! The program says what the measurements leave free, solves the graph with its priors, and says how
//! far off velocity and biases are and how far off they may be expected to be.

use std::error::Error;

use nalgebra::{Isometry3, Vector1, Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::factors::{CombinedInertialFactor, PixelByBody, Prior};
use vislam::inertial::{CameraImu, GRAVITY, Gravity, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::least_squares::{
    Kernel, Key, Manifold, Options, Problem, Solution, SolveError, Values,
};
use vislam::preintegration::{CombinedPreintegrated, CombinedPreintegrator, PreintegrationError};
use vislam::reprojection::Pinhole;
use vislam::simulation::{Flight, Trajectory};

// ANCHOR: sizes
/// Readings between the keyframes, and the seconds for which each of them holds.
pub const READINGS: usize = 200;
pub const STEP: f64 = 0.005;

/// What is known of the first keyframe, as standard deviations: turns, velocity and position, in rad,
/// m/s and m; and of its biases, gyroscope first, in rad/s and m/s².
pub const STATE: [f64; 9] = [2e-3, 2e-3, 2e-3, 0.1, 0.1, 0.1, 0.01, 0.01, 0.01];
pub const BIAS: [f64; 6] = [5e-4, 5e-4, 5e-4, 0.05, 0.05, 0.05];

/// Residuals of pixels that are longer than this many standard deviations count less than their square.
pub const HUBER: f64 = 1.345;
// ANCHOR_END: sizes

/// How far off the search begins along each axis of a landmark, in metres.
const LANDMARK_OFF: f64 = 0.3;

/// The second on the figure-eight at which the first keyframe is taken.
const START: f64 = 1.0;

/// Where the landmarks are, seen from the body halfway: how far to the left and up per metre, and how
/// many metres away.
const LANDMARKS: [[f64; 3]; 6] = [
    [0.30, 0.20, 4.0],
    [-0.20, 0.25, 5.0],
    [0.05, -0.30, 6.0],
    [0.25, -0.20, 7.0],
    [-0.25, -0.15, 8.0],
    [0.00, 0.10, 9.0],
];

// ANCHOR: scene
/// What the unknowns are, or are thought to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    pub states: [NavState; 2],
    pub biases: [ImuBias; 2],
    pub landmarks: Vec<Vector3<f64>>,
}

/// What was measured, what is known of the sensors and of the first keyframe, and the truth.
#[derive(Debug, Clone)]
pub struct Scene {
    pub camera: Pinhole,
    pub body_from_camera: Isometry3<f64>,
    pub noise: ImuNoise,
    pub pixel_sigma: f64,
    /// Each of them holds for [`STEP`] seconds.
    pub readings: Vec<ImuSample>,
    /// By landmark, in both keyframes.
    pub pixels: Vec<[Vector2<f64>; 2]>,
    /// What is said beforehand of the first keyframe.
    pub known_state: NavState,
    pub known_bias: ImuBias,
    /// Where the search begins.
    pub guess: Estimate,
    pub truth: Estimate,
}
// ANCHOR_END: scene

impl Scene {
    /// The scene with the errors of a seed.
    pub fn drawn(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        Self::with_errors(move || StandardNormal.sample(&mut random))
    }

    /// The scene in which every measurement is exact and all that is known is true.
    pub fn exact() -> Self {
        Self::with_errors(|| 0.0)
    }

    // ANCHOR: with_errors
    /// The readings hold for a step each, and so does the motion: the second state is where the exact
    /// readings lead from the first by the Euler rule. What is wrong is drawn, in standard deviations.
    fn with_errors(mut normal: impl FnMut() -> f64) -> Self {
        let Flight { motion, rig, .. } = Flight::new(Trajectory::figure_eight());
        let noise = ImuNoise::mems();
        let known_bias = ImuBias::default();
        let first = motion.at(START).state;
        let first_bias = known_bias.retract(&BIAS.map(|sigma| sigma * normal()));
        let (mut state, mut bias, mut readings) = (first, first_bias, Vec::new());
        for k in 0..READINGS {
            let exact = motion.at(START + STEP * k as f64).sample(&GRAVITY);
            readings.push(noise.corrupt(&exact, &bias, STEP, &mut normal));
            state = state.propagate(&exact, &GRAVITY, STEP);
            bias = noise.walk(&bias, STEP, &mut normal);
        }
        let halfway = motion.at(START + 0.5 * STEP * READINGS as f64).state;
        let truth = Estimate {
            states: [first, state],
            biases: [first_bias, bias],
            landmarks: LANDMARKS.map(|place| place_before(&halfway, place)).into(),
        };
        Self::of(truth, rig, readings, known_bias, normal)
    }
    // ANCHOR_END: with_errors

    /// The scene around a truth: pixels, what is known of the first keyframe, and a guess.
    fn of(
        truth: Estimate,
        rig: CameraImu,
        readings: Vec<ImuSample>,
        known_bias: ImuBias,
        mut normal: impl FnMut() -> f64,
    ) -> Self {
        let camera = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
        let pixel_sigma = 0.5;
        let known_state = truth.states[0].retract(&STATE.map(|sigma| sigma * normal()));
        let mut pixel = |state: &NavState, landmark: &Vector3<f64>| {
            let in_camera = rig.camera_from_world(state) * nalgebra::Point3::from(*landmark);
            let exact =
                camera.project_cam(&in_camera.coords).expect("it is ahead of both keyframes");
            exact + pixel_sigma * Vector2::new(normal(), normal())
        };
        let pixels = truth.landmarks.iter();
        let pixels = pixels.map(|at| truth.states.map(|state| pixel(&state, at))).collect();
        let ahead = |state: NavState, reading: &ImuSample| {
            state.propagate(&reading.corrected(&known_bias), &GRAVITY, STEP)
        };
        let guess = Estimate {
            states: [known_state, readings.iter().fold(known_state, ahead)],
            biases: [known_bias; 2],
            landmarks: truth.landmarks.iter().map(|at| at.add_scalar(LANDMARK_OFF)).collect(),
        };
        Self {
            camera,
            body_from_camera: rig.body_from_camera,
            noise: ImuNoise::mems(),
            pixel_sigma,
            readings,
            pixels,
            known_state,
            known_bias,
            guess,
            truth,
        }
    }

    // ANCHOR: preintegrated
    /// The readings, summed up at the bias that is known.
    pub fn preintegrated(&self) -> Result<CombinedPreintegrated, PreintegrationError> {
        let mut sums = CombinedPreintegrator::new(&self.known_bias, &self.noise)?;
        for reading in &self.readings {
            sums.integrate(reading, STEP)?;
        }
        sums.finish()
    }
    // ANCHOR_END: preintegrated
}

/// A place in the world, from how far to the left and up per metre and how far away a body has it.
fn place_before(state: &NavState, [left, up, away]: [f64; 3]) -> Vector3<f64> {
    state.position + state.world_from_body * (away * Vector3::new(1.0, left, up).normalize())
}

impl Estimate {
    /// The step from this estimate to another, coordinate by coordinate: by keyframe turns, velocity,
    /// position and both biases, then the landmarks.
    pub fn step_to(&self, other: &Self) -> Vec<f64> {
        let mut steps = Vec::new();
        for k in 0..2 {
            steps.extend(step(&self.states[k], &other.states[k]));
            steps.extend(step(&self.biases[k], &other.biases[k]));
        }
        let landmarks = self.landmarks.iter().zip(&other.landmarks);
        steps.extend(landmarks.flat_map(|(from, to)| step(from, to)));
        steps
    }
}

fn step<V: Manifold>(from: &V, to: &V) -> Vec<f64> {
    let mut step = vec![0.0; from.dimension()];
    from.local(to, &mut step);
    step
}

// ANCHOR: graph
/// The graph in the book's library. Camera, clock and gravity are variables of it, and held.
pub struct Graph {
    pub problem: Problem,
    pub states: [Key<NavState>; 2],
    pub biases: [Key<ImuBias>; 2],
    pub landmarks: Vec<Key<Vector3<f64>>>,
}

impl Graph {
    // ANCHOR: measured
    /// What was measured, without what is known beforehand.
    pub fn measured(scene: &Scene, kernel: Kernel) -> Result<Self, Box<dyn Error>> {
        let (mut problem, guess) = (Problem::new(), &scene.guess);
        let states = guess.states.map(|state| problem.add_variable(state));
        let biases = guess.biases.map(|bias| problem.add_variable(bias));
        let landmarks = guess.landmarks.iter().map(|at| problem.add_variable(*at)).collect();
        let extrinsics = problem.add_variable(scene.body_from_camera);
        let time_offset = problem.add_variable(Vector1::new(0.0));
        let gravity = problem.add_variable(Gravity(GRAVITY));
        problem.hold(extrinsics)?;
        problem.hold(time_offset)?;
        problem.hold(gravity)?;
        let mut graph = Self { problem, states, biases, landmarks };
        let readings =
            CombinedInertialFactor::new(states, biases, gravity, &scene.preintegrated()?)?;
        graph.problem.add_factor(readings, Kernel::Squared)?;
        graph.add_pixels(scene, (extrinsics, time_offset), kernel)?;
        Ok(graph)
    }
    // ANCHOR_END: measured
    // ANCHOR_END: graph

    // ANCHOR: pixels
    /// A factor for each pixel, with a kernel.
    fn add_pixels(
        &mut self,
        scene: &Scene,
        (extrinsics, time_offset): (Key<Isometry3<f64>>, Key<Vector1<f64>>),
        kernel: Kernel,
    ) -> Result<(), Box<dyn Error>> {
        for (&landmark, pixels) in self.landmarks.iter().zip(&scene.pixels) {
            for (&state, &pixel) in self.states.iter().zip(pixels) {
                let factor = PixelByBody {
                    state,
                    landmark,
                    extrinsics,
                    time_offset,
                    camera: scene.camera,
                    angular_velocity: Vector3::zeros(),
                    pixel,
                    inverse_sigma: 1.0 / scene.pixel_sigma,
                };
                self.problem.add_factor(factor, kernel)?;
            }
        }
        Ok(())
    }
    // ANCHOR_END: pixels

    // ANCHOR: priors
    /// What was measured and what is known beforehand.
    pub fn new(scene: &Scene, kernel: Kernel) -> Result<Self, Box<dyn Error>> {
        Self::known_to(scene, kernel, STATE, BIAS)
    }

    /// The same with other standard deviations of what is known. An infinite one says nothing.
    pub fn known_to(
        scene: &Scene,
        kernel: Kernel,
        state: [f64; 9],
        bias: [f64; 6],
    ) -> Result<Self, Box<dyn Error>> {
        let mut graph = Self::measured(scene, kernel)?;
        let state = Prior::near(graph.states[0], scene.known_state, state);
        let bias = Prior::near(graph.biases[0], scene.known_bias, bias);
        graph.problem.add_factor(state, Kernel::Squared)?;
        graph.problem.add_factor(bias, Kernel::Squared)?;
        Ok(graph)
    }
    // ANCHOR_END: priors

    // ANCHOR: free
    /// How many directions are free when so much is known, where every measurement is exact.
    pub fn free(state: [f64; 9], bias: [f64; 6]) -> Result<usize, Box<dyn Error>> {
        let scene = Scene::exact();
        let graph = Self::known_to(&scene, Kernel::Squared, state, bias)?;
        Ok(graph.problem.null_space(&graph.values(&scene.truth))?.nullity())
    }
    // ANCHOR_END: free

    // ANCHOR: solved
    /// The minimum, from the guess.
    pub fn solved(&self) -> Result<Estimate, SolveError> {
        let options =
            Options { decrease_tolerance: 1e-15, gradient_tolerance: 1e-9, ..Options::default() };
        let Solution { values, .. } = self.problem.solve(&options)?;
        Ok(self.estimate(&values))
    }
    // ANCHOR_END: solved

    /// What values say of the unknowns.
    pub fn estimate(&self, values: &Values) -> Estimate {
        Estimate {
            states: self.states.map(|key| values[key]),
            biases: self.biases.map(|key| values[key]),
            landmarks: self.landmarks.iter().map(|key| values[*key]).collect(),
        }
    }

    /// The values of an estimate.
    pub fn values(&self, estimate: &Estimate) -> Values {
        let mut values = self.problem.values().clone();
        for k in 0..2 {
            values.set(self.states[k], estimate.states[k]);
            values.set(self.biases[k], estimate.biases[k]);
        }
        for (key, landmark) in self.landmarks.iter().zip(&estimate.landmarks) {
            values.set(*key, *landmark);
        }
        values
    }

    // ANCHOR: bound
    /// The variances that no unbiased estimate falls below, in the order of [`Estimate::step_to`]: the
    /// inverse of the information of measurements and priors at the truth.
    pub fn bound(scene: &Scene) -> Result<Vec<f64>, Box<dyn Error>> {
        let graph = Self::new(scene, Kernel::Squared)?;
        let covariance = graph.problem.covariance(&graph.values(&scene.truth))?;
        let keyframes = graph.states.iter().zip(&graph.biases);
        let keyframes = keyframes.flat_map(|(state, bias)| [state.index(), bias.index()]);
        let variables = keyframes.chain(graph.landmarks.iter().map(Key::index));
        let matrices = variables.filter_map(|variable| covariance.of_number(variable));
        Ok(matrices.flat_map(|matrix| matrix.diagonal().as_slice().to_vec()).collect())
    }
    // ANCHOR_END: bound
}

/// What is asked of an estimate: where it stands in [`Estimate::step_to`], three numbers each, and the
/// unit of a thousandth.
pub const ASKED: [(&str, usize, &str); 4] = [
    ("turn of the second keyframe", 15, "mrad"),
    ("its velocity", 18, "mm/s"),
    ("its bias of the gyroscope", 24, "mrad/s"),
    ("its bias of the accelerometer", 27, "mm/s²"),
];

/// The sum of three squares.
pub fn squared(step: &[f64], at: usize) -> f64 {
    step[at..at + 3].iter().map(|number| number * number).sum()
}

fn main() -> Result<(), Box<dyn Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(0), |seed| seed.parse())?;
    let scene = Scene::drawn(seed);
    let measured = Graph::measured(&scene, Kernel::Squared)?;
    let (rows, columns) = (measured.problem.rows(), measured.problem.columns().count);
    let nullity = Graph::free([f64::INFINITY; 9], [f64::INFINITY; 6])?;
    println!("{columns} unknowns, {rows} equations, {nullity} directions free without priors");
    let off = scene.truth.step_to(&Graph::new(&scene, Kernel::Huber(HUBER))?.solved()?);
    let bound = Graph::bound(&scene)?;
    for (name, at, unit) in ASKED {
        let (off, bound) = (squared(&off, at).sqrt(), bound[at..at + 3].iter().sum::<f64>().sqrt());
        println!("{name}: {:.1} {unit} off, at least {:.1} expected", 1e3 * off, 1e3 * bound);
    }
    Ok(())
}
