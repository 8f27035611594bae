//! Which direction is lost when derivatives belong to several trajectories, and which to choose.

use nalgebra::{DMatrix, DVector, Vector2};
use serde::{Deserialize, Serialize};

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: pose
/// Where a body stands in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// The angle θ from the world's first axis to the body's first axis, in radians, positive
    /// from the first axis to the second. R(θ) takes coordinates of the body to those of the
    /// world.
    pub heading: f64,
    /// The position p in the world, in metres.
    pub position: Vector2<f64>,
}

/// How a step (δθ, δp) moves a pose. Either way θ becomes θ + δθ. A landmark f in the world
/// becomes f + δf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Steps {
    /// δp stands in the world: p becomes p + δp.
    World,
    /// δp stands in the body: p becomes p + R(θ) δp, with the heading before the step.
    Body,
}
// ANCHOR_END: pose

// ANCHOR: measurement
/// What has been measured, by the numbers of poses and landmarks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum What {
    /// A landmark in the coordinates of the body, R(θ)ᵀ (f − p), in metres.
    Seen { pose: usize, landmark: usize, place: Vector2<f64> },
    /// A pose b seen from a pose a: R(θ_a)ᵀ (p_b − p_a) in metres, then θ_b − θ_a in radians.
    Moved { from: usize, to: usize, shift: Vector2<f64>, turn: f64 },
}

/// A measurement of two variables: a pose and a landmark, or the poses `from` and `to`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// What has been measured.
    pub what: What,
    /// The standard deviation of each of its numbers, in metres and in radians.
    pub sigma: f64,
    /// A measurement that has gone into a prior is kept: its derivatives have been taken at
    /// these estimates of its two variables and cannot be taken anew.
    pub kept: Option<[usize; 2]>,
}
// ANCHOR_END: measurement

// ANCHOR: window
/// Variables with all their estimates, numbered from zero in the order in which they were
/// made. The last one is the latest. Each variable has one at least.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// The estimates of each pose.
    pub poses: Vec<Vec<Pose>>,
    /// The estimates of each landmark, in the world and in metres.
    pub landmarks: Vec<Vec<Vector2<f64>>>,
    /// What has been measured.
    pub measurements: Vec<Measurement>,
}
// ANCHOR_END: window

crate::signatures! {
    // ANCHOR: free
    /// The steps of all variables under three motions of the world, in three columns: a shift
    /// by a metre along its first axis, one along its second, and a turn by a radian about its
    /// origin, from the first axis to the second, to first order.
    ///
    /// Three rows for each pose, (δθ, δp), and then two for each landmark.
    fn free_directions(
        poses: Vec<Pose>,
        landmarks: Vec<Vector2<f64>>,
        steps: Steps,
    ) -> DMatrix<f64>;
    // ANCHOR_END: free

    // ANCHOR: linearized
    /// Derivatives of all measurements by the steps of all variables, and residuals. Both are
    /// whitened: each row is divided by its standard deviation.
    ///
    /// Two rows for each measurement of a landmark and three for each of a pose, in the order
    /// of the window and of `What`. Columns as the rows of `free_directions`. The derivatives
    /// of a measurement are taken at those estimates of its two variables that `points`
    /// numbers, which is as long as the list of measurements. The residual is predicted less
    /// measured at the latest estimates of all variables; the difference of an angle is taken
    /// between −π and π before it is divided.
    fn linearized(
        window: Window,
        points: Vec<[usize; 2]>,
        steps: Steps,
    ) -> (DMatrix<f64>, DVector<f64>);
    // ANCHOR_END: linearized

    // ANCHOR: trajectory
    /// One estimate of each variable at which the derivatives of all measurements can be
    /// taken: the latest that is possible, where measurements that are kept have had theirs
    /// taken already. The numbers of the estimates, poses first. `None` when no estimate of
    /// some variable will do.
    fn one_trajectory(window: Window) -> Option<Vec<usize>>;
    // ANCHOR_END: trajectory

    // ANCHOR: lost
    /// Which free directions the derivatives at `points` claim to know, and why. The
    /// directions are those of `free_directions`, taken at the estimates that `trajectory`
    /// numbers, poses first.
    ///
    /// For each direction the number of the measurement that claims most of it. What rows
    /// claim of a direction n is the information nᵀ Hᵀ H n. `None` where all rows together
    /// claim 1e-16 or less of what it would be if nothing cancelled: of the sum over all rows
    /// h of (Σᵢ |hᵢ nᵢ|)². It does not matter whether a measurement is kept.
    fn lost(
        window: Window,
        points: Vec<[usize; 2]>,
        trajectory: Vec<usize>,
        steps: Steps,
    ) -> Vec<Option<usize>>;
    // ANCHOR_END: lost

    // ANCHOR: restored
    /// The rows H + D that claim nothing along any combination of the columns of `directions`,
    /// with the least change D: what D e is on average, squared and summed, is as little as
    /// can be for errors e of mean zero and of this covariance. The covariance is positive
    /// definite, and the directions do not depend on one another.
    fn restored(
        rows: DMatrix<f64>,
        directions: DMatrix<f64>,
        covariance: DMatrix<f64>,
    ) -> DMatrix<f64>;
    // ANCHOR_END: restored
}
