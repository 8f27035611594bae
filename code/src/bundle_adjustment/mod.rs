//! Bundle adjustment: all cameras and all points at once, from nothing but pixels.
//!
//! A [`TinyBa`] is the problem, [`TinyBa::solve`] moves its cameras and points to where the
//! sum of squared, whitened reprojection errors is smallest, and [`BaReport`] says what
//! happened. A [`Solver`] does the same one step at a time.
//!
//! Underneath stands a [`Problem`](crate::least_squares::Problem) of cameras and points, with a
//! [`PixelByCamera`](crate::factors::PixelByCamera) for each observation, and the linear system
//! that eliminates the points: [`LandmarkElimination`](crate::least_squares::LandmarkElimination).

mod assembly;
mod camera;
mod covariance;
mod gauge;
mod solver;

use nalgebra::Vector3;
use thiserror::Error;

use crate::least_squares::{Iteration, Options, SolveError, Stop};
use crate::reprojection::ReprojFactor;

pub use assembly::Dropped;
pub use camera::{BalCamera, Camera, LinearizedPixel, Posed, PosedPinhole};
pub use covariance::BaCovariance;
pub use gauge::GaugeFreedom;
pub use solver::{Solver, TrialStep};

// ANCHOR: tiny_ba
/// A bundle adjustment problem: cameras, points and what was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct TinyBa<C, const D: usize> {
    /// The cameras, moved by [`TinyBa::solve`] unless fixed.
    pub cameras: Vec<C>,
    /// The points in world coordinates, in metres.
    pub points: Vec<Vector3<f64>>,
    /// The observations, in any order.
    pub factors: Vec<ReprojFactor>,
    /// For each camera, whether it stays where it is. Pixels say nothing about where the
    /// world lies, how it is turned and, to a single camera, how large it is: fix
    /// something, or leave it to the damping. This is the gauge.
    pub fixed: Vec<bool>,
    /// For each camera, the rig it is mounted on. Cameras with the same number move by the
    /// same small vector, so what is between them never changes: a stereo camera is two
    /// cameras on one rig.
    pub rig: Vec<usize>,
    /// Threshold of Huber's kernel in standard deviations, or `None` for least squares.
    pub huber: Option<f64>,
}
// ANCHOR_END: tiny_ba

impl<C: Camera<D>, const D: usize> TinyBa<C, D> {
    /// A problem in which each camera moves on its own, none is fixed and errors are
    /// squared.
    pub fn new(cameras: Vec<C>, points: Vec<Vector3<f64>>, factors: Vec<ReprojFactor>) -> Self {
        let fixed = vec![false; cameras.len()];
        let rig = (0..cameras.len()).collect();
        Self { cameras, points, factors, fixed, rig, huber: None }
    }

    // ANCHOR: solve
    /// Moves cameras and points to a minimum of the cost of {eq:bundle-cost}, by
    /// Levenberg-Marquardt.
    ///
    /// # Errors
    ///
    /// [`BaError`] when the problem is not one: see there. The problem is then unchanged.
    pub fn solve(&mut self, options: &Options) -> Result<BaReport, BaError> {
        let mut solver = Solver::new(self, options)?;
        let stop = loop {
            if let Some(reason) = solver.iterate()? {
                break reason;
            }
        };
        let report = solver.report(stop);
        (self.cameras, self.points) = solver.into_state();
        Ok(report)
    }
    // ANCHOR_END: solve
}

// ANCHOR: report
/// What a solve did.
#[derive(Debug, Clone, PartialEq)]
pub struct BaReport {
    /// Half the sum of squares at the end, or what Huber's kernel makes of it.
    pub cost: f64,
    /// Root of the mean squared length of the reprojection error at the end, in pixels.
    /// Both coordinates count: noise of one pixel in each makes √2.
    pub rmse_px: f64,
    /// Why it stopped.
    pub stop: Stop,
    /// Every step that was tried, in order.
    pub iterations: Vec<Iteration>,
    /// Unknowns of the whole system, cameras and points.
    pub full_dim: usize,
    /// Unknowns of the Schur complement, cameras only.
    pub reduced_dim: usize,
    /// What was left out, and why.
    pub dropped: Dropped,
    /// Products of two blocks that eliminating the points took in each iteration: for a
    /// point that n moving rigs see, n (n + 1)/2, as {eq:block-products} says.
    pub block_products: usize,
    /// Blocks of the Schur complement that are kept: of each row those from its first one that
    /// is not zero to the diagonal.
    pub stored_blocks: usize,
}
// ANCHOR_END: report

/// Why a problem cannot be solved as it is.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BaError {
    /// Nothing is left to adjust.
    #[error(
        "there is nothing to adjust: {observations} observations were given and none can be used; \
         every point needs two"
    )]
    Empty {
        /// How many observations there are.
        observations: usize,
    },
    /// A list does not have one entry for each camera.
    #[error("`{list}` has {found} entries for {cameras} cameras; give one for each camera")]
    Length {
        /// `fixed` or `rig`.
        list: &'static str,
        /// Its length.
        found: usize,
        /// The number of cameras.
        cameras: usize,
    },
    /// An observation names a camera or a point that does not exist.
    #[error("observation {observation}: there is no {what} {index}, only {count}; count from zero")]
    Index {
        /// Which observation.
        observation: usize,
        /// `camera` or `point`.
        what: &'static str,
        /// The index it names.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A pixel is not finite.
    #[error("observation {observation}: pixel is ({u}, {v}); remove the observation")]
    Pixel {
        /// Which observation.
        observation: usize,
        /// Its column.
        u: f64,
        /// Its row.
        v: f64,
    },
    /// A standard deviation is not positive and finite.
    #[error("observation {observation}: inverse_sigma is {value}; give a positive, finite number")]
    Sigma {
        /// Which observation.
        observation: usize,
        /// Its `inverse_sigma`, in 1/pixel.
        value: f64,
    },
    /// A point is not finite at the start.
    #[error("point {point} is not finite at the start; remove it or triangulate it again")]
    Point {
        /// Which point.
        point: usize,
    },
    /// The threshold of the kernel is not positive.
    #[error("the Huber threshold is {value}; give a positive number of standard deviations")]
    Huber {
        /// The threshold.
        value: f64,
    },
    /// Some cameras of a rig are fixed and others are not.
    #[error("rig {rig} has a fixed camera and a moving one; fix all of its cameras or none")]
    Rig {
        /// Which rig.
        rig: usize,
    },
    /// A point moves along its rays without changing a pixel.
    #[error(
        "point {point} moves along its rays without changing a pixel, since they have one \
         direction: remove it, or damp the step"
    )]
    Ray {
        /// Which point.
        point: usize,
    },
    /// Cameras and points together move without changing a pixel.
    #[error(
        "no pixel changes in {} of the directions in which the cameras move: {free}",
        free.count()
    )]
    RankDeficient {
        /// In which directions.
        free: GaugeFreedom,
    },
    /// The solver refuses an option, a derivative is too large for a number, a step of Gauss and Newton
    /// is not determined, or it cannot be said what is free.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
