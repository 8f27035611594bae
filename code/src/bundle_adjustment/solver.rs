//! Bundle adjustment one step at a time, and what can be asked on the way.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, SVector, Vector3};

use super::assembly::Assembly;
use super::{BaError, BaReport, Camera, TinyBa};
use crate::factors::MovingCamera;
use crate::least_squares::{
    Iteration, LARGEST_DAMPING, LandmarkElimination, LinearSystem, Options, Point, Problem, Search,
    SolveError, Stop, Values,
};

/// That a damping is one, and overflows nothing.
fn check_damping(damping: f64) -> Result<(), BaError> {
    let fits = (0.0..=LARGEST_DAMPING).contains(&damping);
    fits.then_some(()).ok_or(BaError::Solve(SolveError::Option { name: "damping", value: damping }))
}

// ANCHOR: trial_step
/// A step that was computed and not taken.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialStep<const D: usize> {
    /// For each camera its small vector, zero when the camera is held.
    pub cameras: Vec<SVector<f64, D>>,
    /// For each point its move in metres, zero when the point was dropped.
    pub points: Vec<Vector3<f64>>,
    /// The decrease of the cost that the linearized problem predicts:
    /// {eq:predicted-decrease-in-parts}.
    pub predicted_decrease: f64,
    /// The cost at the end of the step, infinite when a point loses its pixel there.
    pub cost: f64,
}
// ANCHOR_END: trial_step

// ANCHOR: solver
/// A bundle adjustment taken apart and ready for steps, with all the memory that they need.
pub struct Solver<C, const D: usize> {
    pub(super) assembly: Assembly<C, D>,
    search: Search<LandmarkElimination<D>>,
}
// ANCHOR_END: solver

impl<C: Camera<D>, const D: usize> Solver<C, D> {
    /// Checks a problem and prepares for it.
    ///
    /// # Errors
    ///
    /// [`BaError`] names the first thing that is wrong.
    pub fn new(problem: &TinyBa<C, D>, options: &Options) -> Result<Self, BaError> {
        let assembly = Assembly::new(problem)?;
        let system = LandmarkElimination::new::<Vector3<f64>>(&assembly.problem)?;
        let search = Search::new(&assembly.problem, system, options)?;
        Ok(Self { assembly, search })
    }

    /// Tries one step and takes it if it lowers the cost. Says when to stop.
    ///
    /// # Errors
    ///
    /// With the method of Gauss and Newton, [`BaError::Solve`] when pixels leave something free.
    pub fn iterate(&mut self) -> Result<Option<Stop>, BaError> {
        Ok(self.search.iterate(&self.assembly.problem)?)
    }

    /// The step with a given damping from where the solver stands. It is not taken.
    ///
    /// # Errors
    ///
    /// With a damping of zero, or one lost in rounding, [`BaError::RankDeficient`] or [`BaError::Ray`]
    /// when pixels leave something free. [`BaError::Solve`] when that cannot be said or is lost to
    /// rounding, and when the damping is negative, not finite or above 1e12.
    pub fn step(&self, damping: f64) -> Result<TrialStep<D>, BaError> {
        check_damping(damping)?;
        let mut step = vec![0.0; self.values().dimension()];
        let mut system = self.system();
        let prediction = system.step(damping, &mut step);
        let is_clear = |_: &_| {
            damping > 0.0 || !system.is_suspicious() || self.problem().is_determined(self.at())
        };
        match prediction.filter(is_clear) {
            Some(prediction) => Ok(self.trial(&step, prediction.predicted_decrease)),
            None => Err(self.explain()),
        }
    }

    /// A step of all coordinates, camera by camera and point by point.
    pub(super) fn trial(&self, step: &[f64], predicted_decrease: f64) -> TrialStep<D> {
        let Assembly { problem, cameras, points, .. } = &self.assembly;
        let part = |index| &step[self.coordinates(index)];
        TrialStep {
            cameras: cameras.iter().map(|c| SVector::from_column_slice(part(c.index()))).collect(),
            points: points.iter().map(|p| Vector3::from_column_slice(part(p.index()))).collect(),
            predicted_decrease,
            cost: problem.cost(&self.values().retract(step)),
        }
    }

    /// The Schur complement as a dense matrix with its right-hand side: D rows for each of
    /// [`Solver::rows`].
    ///
    /// Implements {eq:reduced-camera-system}, and {eq:damped-reduction} with a damping.
    ///
    /// # Errors
    ///
    /// [`BaError::Ray`] when a point is free and the damping is zero or lost in rounding.
    /// [`BaError::Solve`] when the damping is negative, not finite or above 1e12, or when it cannot be
    /// said what is free.
    pub fn schur_complement(&self, damping: f64) -> Result<(DMatrix<f64>, DVector<f64>), BaError> {
        check_damping(damping)?;
        self.system().schur_complement(damping).map_err(|_| self.explain_points())
    }

    /// The variables and factors of which it is made: a camera that is fixed, or of whose rig none
    /// sees anything, and a point that is not adjusted, are held, and cameras on one rig are tied.
    pub fn problem(&self) -> &Problem {
        &self.assembly.problem
    }

    /// Where the coordinates of a variable stand in a step.
    pub(super) fn coordinates(&self, index: usize) -> Range<usize> {
        self.values().coordinates_of(index).unwrap_or_default()
    }

    /// Where factors are evaluated.
    pub(super) fn at(&self) -> Point<'_> {
        Point { values: self.values(), frozen: None }
    }

    /// A linear system of its own for a question.
    pub(super) fn system(&self) -> LandmarkElimination<D> {
        self.search.system().clone()
    }

    /// The cost where the solver stands.
    pub fn cost(&self) -> f64 {
        self.search.cost()
    }

    /// The norm of the scaled gradient where the solver stands; see
    /// [`Prediction::gradient_norm`](crate::least_squares::Prediction::gradient_norm).
    pub fn gradient_norm(&self) -> f64 {
        self.search.system().gradient_norm()
    }

    /// Where the solver stands.
    pub fn values(&self) -> &Values {
        self.search.values()
    }

    /// The cameras where the solver stands.
    pub fn cameras(&self) -> impl ExactSizeIterator<Item = &C> {
        self.values().of_kind::<MovingCamera<C, D>>().iter().map(|camera| &camera.0)
    }

    /// The points where the solver stands, in metres.
    pub fn points(&self) -> &[Vector3<f64>] {
        self.values().of_kind()
    }

    /// The iterations so far.
    pub fn iterations(&self) -> &[Iteration] {
        self.search.iterations()
    }

    /// For each camera the row of D×D blocks that it has in the Schur complement, `None` when
    /// it is held.
    pub fn rows(&self) -> Vec<Option<usize>> {
        let mut rows = self.search.system().rows(self.problem());
        rows.truncate(self.assembly.cameras.len());
        rows
    }

    /// The memory of the linear system and of the state, in bytes, beside the observations. The solver takes
    /// all of it when it is made.
    pub fn bytes(&self) -> usize {
        let cameras = size_of::<C>() * self.assembly.cameras.len();
        let points = size_of::<Vector3<f64>>() * self.assembly.points.len();
        self.search.system().bytes() + self.search.bytes() + 4 * (cameras + points)
    }

    /// The cameras and the points.
    pub fn into_state(self) -> (Vec<C>, Vec<Vector3<f64>>) {
        (self.cameras().cloned().collect(), self.points().to_vec())
    }

    /// What happened so far.
    pub fn report(&self, stop: Stop) -> BaReport {
        let rows = self.rows().into_iter().flatten().max().map_or(0, |last| last + 1);
        let reduced_dim = D * rows;
        BaReport {
            cost: self.cost(),
            rmse_px: self.rmse_px(),
            stop,
            iterations: self.iterations().to_vec(),
            full_dim: reduced_dim + 3 * self.assembly.landmarks.len(),
            reduced_dim,
            dropped: self.assembly.dropped,
            block_products: self.search.system().block_products(),
            stored_blocks: self.search.system().stored_blocks(),
        }
    }

    /// See [`BaReport::rmse_px`].
    fn rmse_px(&self) -> f64 {
        let Assembly { observations, cameras, points, .. } = &self.assembly;
        let square = |factor: &crate::reprojection::ReprojFactor| {
            let camera = &self.values()[cameras[factor.keyframe]].0;
            let pixel = camera.project(&self.values()[points[factor.point]]);
            pixel.map_or(f64::NAN, |pixel| (pixel - factor.pixel).norm_squared())
        };
        let squares: f64 = observations.iter().map(square).sum();
        (squares / observations.len() as f64).sqrt()
    }
}
