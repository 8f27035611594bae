//! Motions that are nearly degenerate, and estimates that are nearly consistent.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, Vector3};
use vislam::least_squares::Spectrum;
use vislam::observability::{BiasAssumption, Direction, Window};
use vislam::simulation::{Flight, ScalarTrajectory, Trajectory};

use super::certainty::scale_information;
use super::worked::{VELOCITY, log_distance, of_flight, spectrum, turning, window};
use crate::random::Random;

/// How fast the body sways, in rad/s.
pub const SWAY_RATE: f64 = 3.0;
/// Greatest acceleration of the swaying, in m/s².
pub const AMPLITUDES: [f64; 9] = [1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0];
/// Points to which a power law is fitted, from the left.
const FITTED: usize = 5;

/// Constant velocity, turning.
pub fn coasting() -> Trajectory {
    Trajectory::constant_velocity(&VELOCITY, turning())
}

/// Constant velocity, turning, and a sway to the side.
pub fn swaying(amplitude: f64) -> Trajectory {
    let mut motion = coasting();
    let wave = amplitude / (SWAY_RATE * SWAY_RATE);
    motion.position[1] =
        ScalarTrajectory { rate: VELOCITY.y, ..ScalarTrajectory::wave(wave, SWAY_RATE, 0.0) };
    motion
}

/// The standard deviation, in percent, of the distance between the first and the last position.
fn distance_percent(window: &Window) -> f64 {
    percent(&spectrum(window), window)
}

/// The same when the window's spectrum is known.
pub fn percent(spectrum: &Spectrum, window: &Window) -> f64 {
    let sigma = spectrum.sigma(&log_distance(window));
    100.0 * sigma.expect("the motions that are asked about have a scale")
}

/// The standard deviations, in percent, for each amplitude of the sway.
pub struct Swayed {
    pub known: [f64; 9],
    pub unknown: [f64; 9],
    /// The least that can be with known biases.
    pub least: [f64; 9],
}

pub fn swayed() -> &'static Swayed {
    static SWAYED: OnceLock<Swayed> = OnceLock::new();
    SWAYED.get_or_init(|| {
        let windows = |assumption| AMPLITUDES.map(|a| window(swaying(a), assumption));
        let known = windows(BiasAssumption::KNOWN);
        Swayed {
            known: known.each_ref().map(distance_percent),
            unknown: windows(BiasAssumption::CONSTANT).each_ref().map(distance_percent),
            least: known.each_ref().map(|window| 100.0 / scale_information(window).sqrt()),
        }
    })
}

/// At constant velocity of the body, with the camera on a lever arm, in metres.
pub fn lever_percent(lever: f64, assumption: BiasAssumption) -> f64 {
    let flight = Flight::brief(coasting()).with_lever(lever * Vector3::x());
    distance_percent(&of_flight(&flight, assumption))
}

/// The slope of a straight line through the logarithms of the first points.
pub fn exponent(points: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let points = points.into_iter().take(FITTED);
    let points: Vec<_> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
    let (x, y) = (x / count, y / count);
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// By how much estimates differ: radians, m/s, m/s² and metres alike.
pub const DISAGREEMENTS: [f64; 7] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1];

/// What is left free and how sure the yaw seems to be when pixels are linearized at the truth and
/// readings at an estimate that is off by so much.
pub struct Mixed {
    pub free: usize,
    pub yaw_degrees: f64,
    /// How much of each translation lies outside of the null space.
    pub leaves: [f64; 3],
}

/// For each of the disagreements.
pub fn all_mixed() -> &'static [Mixed; 7] {
    static MIXED: OnceLock<[Mixed; 7]> = OnceLock::new();
    MIXED.get_or_init(|| DISAGREEMENTS.map(mixed))
}

fn mixed(disagreement: f64) -> Mixed {
    let truth = window(Trajectory::figure_eight(), BiasAssumption::CONSTANT);
    let mut random = Random::new(31);
    let step: Vec<f64> = (0..truth.dimension()).map(|_| random.normal(disagreement)).collect();
    let elsewhere = truth.retract(&step);
    let rows = |window: &Window| window.linearize().expect("the estimates are close").0;
    let (mut jacobian, other): (DMatrix<f64>, _) = (rows(&truth), rows(&elsewhere));
    let first = 2 * truth.observations.len();
    let readings = jacobian.nrows() - first;
    jacobian.rows_mut(first, readings).copy_from(&other.rows(first, readings));
    let spectrum = Spectrum::of(&jacobian).expect("the disagreement is above rounding");
    let null_space = spectrum.null_space();
    let leaves =
        [0, 1, 2].map(|axis| null_space.leaves(&truth.direction(Direction::Translation(axis))));
    let sigma = spectrum.sigma(&first_yaw(&truth)).expect("the yaw seems to be known");
    Mixed { free: spectrum.zeros, yaw_degrees: sigma.to_degrees(), leaves }
}

/// The gradient of the yaw of the first state.
pub fn first_yaw(window: &Window) -> DVector<f64> {
    let mut gradient = DVector::zeros(window.dimension());
    let up = window.states[0].world_from_body.inverse() * Vector3::z();
    gradient.rows_mut(0, 3).copy_from(&up);
    gradient
}
