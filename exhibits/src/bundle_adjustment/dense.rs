//! Small bundle adjustments as dense matrices, with nothing eliminated.

use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use vislam::bundle_adjustment::{Camera, PosedPinhole, Solver};
use vislam::simulation::Scene;

use super::whole::{Ba, Blocks, Whole, beside, solver};
use crate::random::Random;

const CAMERAS: usize = 4;
/// The first two cameras are fixed, so that nothing is free.
const FIXED: usize = 2;
const POINTS: usize = 6;

/// Four cameras and six points that are not all seen by all, a damping and a step of the cameras.
pub struct Case {
    pub problem: Ba,
    /// The 2×6 blocks of all observations in one matrix, whitened, and the same for the points.
    pub by_cameras: DMatrix<f64>,
    pub by_points: DMatrix<f64>,
    /// Predicted less measured, whitened.
    pub residual: DVector<f64>,
    /// The blocks of the normal equations: of the cameras alone, of the points alone, and who saw whom.
    pub a: DMatrix<f64>,
    pub b: DMatrix<f64>,
    pub w: DMatrix<f64>,
    /// The gradients of the cost.
    pub cameras_gradient: DVector<f64>,
    pub points_gradient: DVector<f64>,
    pub damping: f64,
    pub cameras_step: DVector<f64>,
}

/// Predicted less measured, whitened, two numbers for each observation.
fn residuals(problem: &Ba) -> DVector<f64> {
    let mut residuals = DVector::zeros(2 * problem.factors.len());
    for (index, factor) in problem.factors.iter().enumerate() {
        let pixel = problem.cameras[factor.keyframe].project(&problem.points[factor.point]);
        let residual = factor.residual(&pixel.expect("the points lie in front of all cameras"));
        residuals.fixed_rows_mut::<2>(2 * index).copy_from(&residual);
    }
    residuals
}

impl Case {
    pub fn random(random: &mut Random) -> Self {
        let seed = random.uniform(0.0..1e9) as u64;
        let mut problem = Scene::ring(CAMERAS, POINTS, 1.0, seed).problem;
        problem.fixed[1] = true;
        for point in 0..POINTS {
            let missing = random.uniform(0.0..3.0 * CAMERAS as f64) as usize;
            problem.factors.retain(|f| (f.point, f.keyframe) != (point, missing));
        }
        for factor in &mut problem.factors {
            factor.inverse_sigma = random.uniform(0.5..2.0);
        }
        let whole = Whole::new(&problem);
        let Blocks { cameras: a, coupling: w, points: b } = whole.blocks();
        let Whole { cameras: by_cameras, points: by_points } = whole;
        let residual = residuals(&problem);
        Self {
            a,
            b,
            w,
            cameras_gradient: by_cameras.tr_mul(&residual),
            points_gradient: by_points.tr_mul(&residual),
            by_cameras,
            by_points,
            residual,
            damping: random.logarithmic(0.01..1.0),
            cameras_step: DVector::from_fn(6 * (CAMERAS - FIXED), |_, _| random.normal(0.1)),
            problem,
        }
    }

    pub fn solver(&self) -> Solver<PosedPinhole, 6> {
        solver(&self.problem)
    }

    /// All columns of the Jacobian, those of the cameras first.
    pub fn jacobian(&self) -> DMatrix<f64> {
        beside(&self.by_cameras, &self.by_points)
    }

    /// The same by central differences of the whitened pixels.
    pub fn jacobian_by_differences(&self) -> DMatrix<f64> {
        let (cameras, step) = (self.by_cameras.ncols(), 1e-5);
        let pixels = |unknown: usize, step: f64| {
            let mut moved = self.problem.clone();
            if unknown < cameras {
                let camera = &mut moved.cameras[FIXED + unknown / 6];
                *camera = camera.retract(&Vector6::ith(unknown % 6, step));
            } else {
                let point = unknown - cameras;
                moved.points[point / 3] += Vector3::ith(point % 3, step);
            }
            let pixels = moved.factors.iter().flat_map(|factor| {
                let pixel = moved.cameras[factor.keyframe].project(&moved.points[factor.point]);
                let pixel = factor.inverse_sigma * pixel.expect("the points stay in front");
                [pixel.x, pixel.y]
            });
            DVector::from_iterator(2 * moved.factors.len(), pixels)
        };
        let columns: Vec<_> = (0..cameras + self.by_points.ncols())
            .map(|unknown| (pixels(unknown, step) - pixels(unknown, -step)) / (2.0 * step))
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// The Jacobian and the residual with one more measurement of zero for each unknown, held as
    /// firmly as the damping says.
    pub fn with_measurements_of_zero(&self) -> (DMatrix<f64>, DVector<f64>) {
        let jacobian = self.jacobian();
        let (rows, columns) = jacobian.shape();
        let mut longer = jacobian.clone().resize_vertically(rows + columns, 0.0);
        for (index, column) in jacobian.column_iter().enumerate() {
            longer[(rows + index, index)] = self.damping.sqrt() * column.norm();
        }
        (longer, self.residual.clone().resize_vertically(rows + columns, 0.0))
    }
}

/// The step after which a linear residual is shortest, by singular values.
pub fn best_step(jacobian: &DMatrix<f64>, residual: &DVector<f64>) -> DVector<f64> {
    let fit = jacobian.clone().svd(true, true).solve(&-residual, 1e-12);
    fit.unwrap_or_else(|_| DVector::from_element(jacobian.ncols(), f64::NAN))
}

/// The inverse, or a matrix that no comparison accepts.
pub fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix.clone().try_inverse().unwrap_or_else(|| matrix.map(|_| f64::NAN))
}

/// The matrix with its diagonal grown by a fraction of itself.
pub fn damped(matrix: &DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    let mut damped = matrix.clone();
    damped.set_diagonal(&(matrix.diagonal() * (1.0 + damping)));
    damped
}
