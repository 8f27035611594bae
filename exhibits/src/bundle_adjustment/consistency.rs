//! Are errors as large as their covariances say?

use std::sync::OnceLock;

use nalgebra::DVector;
use vislam::filtering::chi_square_band;
use vislam::least_squares::Options;
use vislam::manifold::se3;
use vislam::simulation::{Scene, at_true_scale};

use super::whole::{at_truth, solver};
use crate::chapter::Chapter;
use crate::record::RecordValue;

/// Six for each of the seven cameras that move, less one for scale.
pub const DEGREES: usize = 41;
pub const RUNS: usize = 500;
const LIVE_RUNS: usize = 100;
/// In the figure.
pub const SHOWN_RUNS: usize = 120;
/// Probability outside the band of the mean, and outside that of a single run.
pub const OUTSIDE_MEAN: f64 = 0.001;
pub const OUTSIDE_RUN: f64 = 0.05;

/// The normalized error of a ring's cameras, with noise of so many pixels where one was stated.
pub fn normalized_error(seed: u64, noise: f64) -> f64 {
    let mut scene = Scene::ring(8, 40, noise, seed);
    scene.problem.factors.iter_mut().for_each(|factor| factor.inverse_sigma = 1.0);
    let truth = at_truth(&scene);
    let options = Options { decrease_tolerance: 1e-10, ..Options::large_problem() };
    scene.problem.solve(&options).expect("the ring is a problem");
    let estimate = at_true_scale(&scene.problem.cameras, &scene.true_cameras);
    let pairs = truth.cameras.iter().zip(&estimate).skip(1);
    let error = pairs.flat_map(|(truth, estimate)| {
        <[f64; 6]>::from(se3::local(&truth.camera_from_world, &estimate.camera_from_world))
    });
    let error = DVector::from_vec(error.collect());
    // The metric of the Schur complement, which is zero along scale.
    let (reduced, _) = solver(&truth).schur_complement(0.0).expect("every point has parallax");
    error.dot(&(reduced * &error))
}

/// The ends of the band of a single run.
pub fn of_run() -> [f64; 2] {
    chi_square_band(OUTSIDE_RUN, DEGREES).expect("a probability")
}

/// Mean, the ends of its band, and percent of the runs in their own.
pub fn summary(errors: &[f64]) -> (f64, [f64; 2], f64) {
    let runs = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / runs;
    let of_sum = chi_square_band(OUTSIDE_MEAN, errors.len() * DEGREES).expect("a probability");
    let of_mean = of_sum.map(|end| end / runs);
    let [low, high] = of_run();
    let inside = errors.iter().filter(|error| (low..high).contains(*error)).count();
    (mean, of_mean, 100.0 * inside as f64 / runs)
}

/// Normalized errors of the first rings.
pub fn errors(runs: usize, noise: f64) -> Vec<f64> {
    (0..runs as u64).map(|seed| normalized_error(seed, noise)).collect()
}

/// The same with the noise as stated, for as many rings as the page and its figure show.
pub fn live_errors() -> &'static [f64] {
    static ERRORS: OnceLock<Vec<f64>> = OnceLock::new();
    ERRORS.get_or_init(|| errors(SHOWN_RUNS, 1.0))
}

/// Registers the numbers and the record.
pub fn numbers(chapter: &mut Chapter) {
    let (mean, [low, high], inside) = summary(&live_errors()[..LIVE_RUNS]);
    chapter.number("nees_degrees", DEGREES as f64, "", 0);
    chapter.number("nees_live_runs", LIVE_RUNS as f64, "", 0);
    chapter.number("nees_live_mean", mean, "", 1);
    chapter.number("nees_live_low", low, "", 1);
    chapter.number("nees_live_high", high, "", 1);
    chapter.number("nees_live_inside", inside, "%", 0);
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("runs", RUNS.to_string()),
        ("scene", "Scene::ring(8, 40, 1.0, seed)".to_owned()),
        ("seeds", "0 and up".to_owned()),
    ];
    chapter.record("ba_consistency", inputs, consistency);
}

fn consistency() -> Vec<RecordValue> {
    let errors = errors(RUNS, 1.0);
    let (mean, [low, high], inside) = summary(&errors);
    let [run_low, run_high] = of_run();
    let value = |name, value, unit, decimals| RecordValue::new(name, value, unit, decimals, 1e-6);
    vec![
        value("runs", RUNS as f64, "", 0),
        value("mean", mean, "", 2),
        value("low", low, "", 2),
        value("high", high, "", 2),
        value("run_low", run_low, "", 1),
        value("run_high", run_high, "", 1),
        value("inside", inside, "%", 1),
    ]
}
