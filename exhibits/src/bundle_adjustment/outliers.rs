//! What wrong matches do.

use std::sync::OnceLock;

use vislam::bundle_adjustment::Camera;
use vislam::least_squares::Options;
use vislam::simulation::{Scene, at_true_scale};

use super::certainty::expected_cost;
use super::whole::{Ba, solver};
use crate::chapter::Chapter;

pub const SEEDS: usize = 16;
const SHARE: f64 = 0.1;
const PIXELS: f64 = 30.0;
const HUBER: f64 = 1.5;

/// What came of one solve.
#[derive(Clone, Copy)]
pub struct Outcome {
    /// Root mean square of the moving cameras' errors in position, in centimetres, at true scale.
    pub cameras_cm: f64,
    /// Root mean squared length of the errors of the right matches, in pixels.
    pub right_px: f64,
    /// The same of all matches.
    pub all_px: f64,
    pub iterations: usize,
    /// The length of the scaled gradient at the end, over that at the start.
    pub gradient: f64,
}

/// Least squares without wrong matches, Huber's kernel with them, least squares with them.
pub fn outcomes() -> &'static [[Outcome; 3]] {
    static OUTCOMES: OnceLock<Vec<[Outcome; 3]>> = OnceLock::new();
    OUTCOMES.get_or_init(|| (0..SEEDS as u64).map(of_seed).collect())
}

fn of_seed(seed: u64) -> [Outcome; 3] {
    let clean = Scene::ring(8, 40, 1.0, seed);
    let spoiled = clean.clone().with_outliers(SHARE, PIXELS, seed + 100);
    [(&clean, None), (&spoiled, Some(HUBER)), (&spoiled, None)]
        .map(|(scene, huber)| outcome(scene, huber))
}

fn outcome(scene: &Scene, huber: Option<f64>) -> Outcome {
    let mut problem = Ba { huber, ..scene.problem.clone() };
    let options = Options { max_iterations: 200, ..Options::default() };
    let report = problem.solve(&options).expect("the ring is a problem");
    let at_end = solver(&problem).gradient_norm();
    let gradient = at_end / report.iterations[0].gradient_norm;
    let cameras = at_true_scale(&problem.cameras, &scene.true_cameras);
    let pairs = cameras.iter().zip(&scene.true_cameras).skip(1);
    let errors = pairs.map(|(one, other)| (one.centre() - other.centre()).norm_squared());
    let (mut right, mut all) = (Vec::new(), Vec::new());
    for (index, factor) in problem.factors.iter().enumerate() {
        let pixel = problem.cameras[factor.keyframe].project(&problem.points[factor.point]);
        let error = pixel.map_or(f64::NAN, |pixel| (pixel - factor.pixel).norm_squared());
        all.push(error);
        if scene.outliers.binary_search(&index).is_err() {
            right.push(error);
        }
    }
    Outcome {
        cameras_cm: 100.0 * root_mean(&errors.collect::<Vec<_>>()),
        right_px: root_mean(&right),
        all_px: root_mean(&all),
        iterations: report.iterations.len(),
        gradient,
    }
}

fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Least, middle and greatest.
fn spread(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let (middle, last) = (values.len() / 2, values.len() - 1);
    [values[0], 0.5 * (values[last / 2] + values[middle]), values[last]]
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("outlier_seeds", SEEDS as f64, "", 0);
    chapter.number("outlier_percent", 100.0 * SHARE, "%", 0);
    chapter.number("outlier_px", PIXELS, "px", 0);
    chapter.number("outlier_huber", HUBER, "", 1);
    let left = expected_cost(320.0, 8.0, 40.0);
    chapter.number("outlier_observations", 320.0, "", 0);
    chapter.number("outlier_left", left, "", 0);
    chapter.number("outlier_expected_px", (left / 320.0).sqrt(), "px", 2);
    let of_all = |way: usize, value: fn(&Outcome) -> f64| {
        spread(outcomes().iter().map(|outcome| value(&outcome[way])).collect())
    };
    for (way, names) in [
        ["outlier_clean_least", "outlier_clean_middle", "outlier_clean_most"],
        ["outlier_huber_least", "outlier_huber_middle", "outlier_huber_most"],
        ["outlier_squares_least", "outlier_squares_middle", "outlier_squares_most"],
    ]
    .into_iter()
    .enumerate()
    {
        for (name, value) in names.into_iter().zip(of_all(way, |outcome| outcome.cameras_cm)) {
            chapter.number(name, value, "cm", 1);
        }
    }
    let names = ["outlier_clean_right_px", "outlier_huber_right_px", "outlier_squares_right_px"];
    for (way, name) in names.into_iter().enumerate() {
        chapter.number(name, of_all(way, |outcome| outcome.right_px)[1], "px", 2);
    }
    for (way, name) in [(1, "outlier_huber_all_px"), (2, "outlier_squares_all_px")] {
        chapter.number(name, of_all(way, |outcome| outcome.all_px)[1], "px", 2);
    }
    let rises = outcomes().iter().filter(|outcome| outcome[1].all_px > outcome[2].all_px);
    chapter.number("outlier_rises", rises.count() as f64, "", 0);
    let better = outcomes().iter().filter(|outcome| outcome[1].cameras_cm < outcome[2].cameras_cm);
    chapter.number("outlier_better", better.count() as f64, "", 0);
    let longest = outcomes().iter().map(|outcome| outcome[2].iterations).max().unwrap_or(0);
    chapter.number("outlier_iterations", longest as f64, "", 0);
    let steepest = outcomes().iter().map(|outcome| outcome[2].gradient).fold(0.0, f64::max);
    chapter.number("outlier_gradient_exponent", steepest.log10().ceil(), "", 0);
}
