//! The whole system, cameras and points, without elimination.

use nalgebra::{DMatrix, DVector};
use vislam::bundle_adjustment::{Camera, PosedPinhole, Solver, TinyBa, TrialStep};
use vislam::least_squares::{Options, Spectrum};
use vislam::simulation::Scene;

pub type Ba = TinyBa<PosedPinhole, 6>;

/// The solver at the start of a problem that is known to be one.
pub fn solver(problem: &Ba) -> Solver<PosedPinhole, 6> {
    Solver::new(problem, &Options::large_problem()).expect("the scene is a problem")
}

/// A scene's problem with the truth for a start.
pub fn at_truth(scene: &Scene) -> Ba {
    Ba {
        cameras: scene.true_cameras.clone(),
        points: scene.true_points.clone(),
        ..scene.problem.clone()
    }
}

/// The problem after a multiple of a step.
pub fn moved(problem: &Ba, step: &TrialStep<6>, times: f64) -> Ba {
    let mut moved = problem.clone();
    for (camera, change) in moved.cameras.iter_mut().zip(&step.cameras) {
        *camera = camera.retract(&(times * change));
    }
    for (point, change) in moved.points.iter_mut().zip(&step.points) {
        *point += times * change;
    }
    moved
}

/// The Jacobian of all whitened pixels: six columns for each rig that is not fixed, and three for
/// each point.
pub struct Whole {
    pub cameras: DMatrix<f64>,
    pub points: DMatrix<f64>,
}

impl Whole {
    pub fn new(problem: &Ba) -> Self {
        let rigs = problem.rig.iter().zip(&problem.fixed);
        let mut moving: Vec<usize> = rigs.filter(|(_, fixed)| !**fixed).map(|of| *of.0).collect();
        moving.sort_unstable();
        moving.dedup();
        let rows = 2 * problem.factors.len();
        let mut cameras = DMatrix::zeros(rows, 6 * moving.len());
        let mut points = DMatrix::zeros(rows, 3 * problem.points.len());
        for (index, factor) in problem.factors.iter().enumerate() {
            let camera = &problem.cameras[factor.keyframe];
            let view = camera.differentiate(&problem.points[factor.point]).expect("a pixel");
            let rig = moving.iter().position(|rig| *rig == problem.rig[factor.keyframe]);
            if let Some(column) = rig {
                let block = factor.inverse_sigma * view.by_camera;
                cameras.view_mut((2 * index, 6 * column), (2, 6)).copy_from(&block);
            }
            let block = factor.inverse_sigma * view.by_point;
            points.view_mut((2 * index, 3 * factor.point), (2, 3)).copy_from(&block);
        }
        Self { cameras, points }
    }

    /// The blocks of the normal equations.
    pub fn blocks(&self) -> Blocks {
        Blocks {
            cameras: self.cameras.tr_mul(&self.cameras),
            coupling: self.cameras.tr_mul(&self.points),
            points: self.points.tr_mul(&self.points),
        }
    }

    /// What no motion of the points can explain of a motion of the cameras, in squared pixels.
    pub fn unexplained(&self, step: &DVector<f64>) -> f64 {
        let moved = &self.cameras * step;
        let directions = self.points.clone().qr().q();
        let explained = &directions * directions.tr_mul(&moved);
        (moved - explained).norm_squared()
    }

    /// The rank, counted by singular values.
    pub fn rank(&self) -> usize {
        let all = beside(&self.cameras, &self.points);
        all.ncols() - Spectrum::of(&all).expect("zeros are told apart from what is seen").zeros
    }
}

/// Two matrices of the same height, side by side.
pub fn beside(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = left.clone().resize_horizontally(left.ncols() + right.ncols(), 0.0);
    both.columns_mut(left.ncols(), right.ncols()).copy_from(right);
    both
}

/// The normal equations of cameras and points.
pub struct Blocks {
    pub cameras: DMatrix<f64>,
    /// Six rows for each camera, three columns for each point.
    pub coupling: DMatrix<f64>,
    pub points: DMatrix<f64>,
}

impl Blocks {
    pub fn points_inverse(&self) -> DMatrix<f64> {
        self.points.clone().try_inverse().expect("every point is seen from two sides")
    }

    /// The Schur complement.
    pub fn reduced(&self) -> DMatrix<f64> {
        &self.cameras - &self.coupling * self.points_inverse() * self.coupling.transpose()
    }

    /// Its inverse.
    pub fn covariance(&self) -> DMatrix<f64> {
        self.reduced().try_inverse().expect("nothing is free")
    }

    /// The inverse of the whole matrix, cameras first.
    pub fn whole_inverse(&self) -> DMatrix<f64> {
        let (cameras, points) = self.coupling.shape();
        let mut whole =
            beside(&self.cameras, &self.coupling).resize_vertically(cameras + points, 0.0);
        whole
            .rows_mut(cameras, points)
            .copy_from(&beside(&self.coupling.transpose(), &self.points));
        whole.try_inverse().expect("nothing is free")
    }
}
