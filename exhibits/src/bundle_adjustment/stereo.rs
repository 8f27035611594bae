//! What a stereo camera fixes.

use nalgebra::{DMatrix, DVector};
use vislam::simulation::Scene;

use super::whole::{Ba, Whole, at_truth, solver};
use crate::chapter::Chapter;

const RIGS: usize = 8;
const POINTS: usize = 40;
const SEED: u64 = 5;
/// Metres between the two cameras of a rig.
pub const BASELINE: f64 = 0.1;

/// One camera at each place or two, at the truth.
fn ring(baseline: Option<f64>, pinned: bool) -> Ba {
    let scene = match baseline {
        Some(baseline) => Scene::stereo_ring(RIGS, POINTS, baseline, 1.0, SEED),
        None => Scene::ring(RIGS, POINTS, 1.0, SEED),
    };
    let mut problem = at_truth(&scene);
    if !pinned {
        problem.fixed.fill(false);
    }
    problem
}

/// Ascending eigenvalues of the Schur complement, each unknown in the unit in which its own
/// curvature is one.
pub fn eigenvalues(baseline: Option<f64>, pinned: bool) -> Vec<f64> {
    let blocks = Whole::new(&ring(baseline, pinned)).blocks();
    let unit = blocks.cameras.diagonal().map(|curvature| curvature.sqrt().recip());
    sorted(blocks.reduced().component_mul(&(&unit * unit.transpose())))
}

fn sorted(matrix: DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// What the second cameras say about the size of the world, when all else follows it.
pub fn scale_information(focal_length: f64, baseline: f64, sigma: f64, depths: &[f64]) -> f64 {
    depths.iter().map(|depth| (focal_length * baseline / (sigma * depth)).powi(2)).sum()
}

/// Depths of all points in the second cameras of all rigs, in metres.
pub fn right_depths(problem: &Ba) -> Vec<f64> {
    let right = problem.factors.iter().filter(|factor| factor.keyframe % 2 == 1);
    let depth = |camera: usize, point: usize| {
        let pose = &problem.cameras[camera].camera_from_world;
        (pose.rotation * problem.points[point] + pose.translation.vector).z
    };
    right.map(|factor| depth(factor.keyframe, factor.point)).collect()
}

/// The standard deviation in percent of the distance from the fixed rig to the opposite one, and
/// the least that it can be.
fn size_percent(baseline: f64) -> (f64, f64) {
    let problem = ring(Some(baseline), true);
    let covariance = solver(&problem).covariance().expect("stereo fixes scale");
    let opposite = problem.cameras[RIGS].centre();
    let arm = opposite - problem.cameras[0].centre();
    // The centre moves by −ρ − φ × C.
    let unit = arm.normalize();
    let mut slope = DVector::zeros(6);
    slope.rows_mut(0, 3).copy_from(&-unit);
    slope.rows_mut(3, 3).copy_from(&-opposite.cross(&unit));
    let block = covariance.camera(RIGS).expect("the rig moves");
    let variance = slope.dot(&(block * &slope));
    let focal_length = problem.cameras[0].intrinsics.fx;
    let information = scale_information(focal_length, baseline, 1.0, &right_depths(&problem));
    (100.0 * variance.sqrt() / arm.norm(), 100.0 / information.sqrt())
}

pub fn numbers(chapter: &mut Chapter) {
    let free = |baseline, pinned| {
        let free = solver(&ring(baseline, pinned)).gauge_freedom();
        free.expect("every point has parallax").count() as f64
    };
    chapter.number("stereo_free", free(Some(BASELINE), false), "", 0);
    chapter.number("stereo_pinned_free", free(Some(BASELINE), true), "", 0);
    let raw = sorted(Whole::new(&ring(Some(BASELINE), true)).blocks().reduced());
    chapter.number("stereo_raw", raw[0], "", 0);
    chapter.number("stereo_raw_next", raw[1], "", 0);
    let scaled = eigenvalues(Some(BASELINE), true);
    chapter.number("stereo_ratio", scaled[1] / scaled[0], "", 0);
    let mono = eigenvalues(None, true);
    chapter.number("stereo_mono_exponent", (mono[0].abs() / mono[1]).log10().ceil(), "", 0);
    chapter.number("stereo_baseline_cm", 100.0 * BASELINE, "cm", 0);
    let (size, least) = size_percent(BASELINE);
    chapter.number("stereo_size_percent", size, "%", 2);
    chapter.number("stereo_least_percent", least, "%", 2);
    let (size, least) = size_percent(0.1 * BASELINE);
    chapter.number("stereo_short_cm", 10.0 * BASELINE, "cm", 0);
    chapter.number("stereo_short_percent", size, "%", 2);
    chapter.number("stereo_short_least_percent", least, "%", 2);
}
