//! First estimates in the plane. Edition 2.
//!
//! `cargo test -p exercises first_estimates`

use exercise_spec::first_estimates::{Pose, Steps, Window};
use nalgebra::{DMatrix, DVector, Vector2};

/// The steps of all variables under three motions of the world, in three columns: a shift
/// by a metre along its first axis, one along its second, and a turn by a radian about its
/// origin, from the first axis to the second, to first order.
///
/// Three rows for each pose, (δθ, δp), and then two for each landmark.
pub fn free_directions(
    poses: Vec<Pose>,
    landmarks: Vec<Vector2<f64>>,
    steps: Steps,
) -> DMatrix<f64> {
    let _ = (poses, landmarks, steps);
    todo!("how does each variable step when the world is moved under it?")
}

/// Derivatives of all measurements by the steps of all variables, and residuals. Both are
/// whitened: each row is divided by its standard deviation.
///
/// Two rows for each measurement of a landmark and three for each of a pose, in the order
/// of the window and of `What`. Columns as the rows of `free_directions`. The derivatives
/// of a measurement are taken at those estimates of its two variables that `points`
/// numbers, which is as long as the list of measurements. The residual is predicted less
/// measured at the latest estimates of all variables; the difference of an angle is taken
/// between −π and π before it is divided.
pub fn linearized(
    window: Window,
    points: Vec<[usize; 2]>,
    steps: Steps,
) -> (DMatrix<f64>, DVector<f64>) {
    let _ = (window, points, steps);
    todo!("how do the numbers of each measurement change, and how far are they off?")
}

/// One estimate of each variable at which the derivatives of all measurements can be
/// taken: the latest that is possible, where measurements that are kept have had theirs
/// taken already. The numbers of the estimates, poses first. `None` when no estimate of
/// some variable will do.
pub fn one_trajectory(window: Window) -> Option<Vec<usize>> {
    let _ = window;
    todo!("which estimates can all derivatives share?")
}

/// Which free directions the derivatives at `points` claim to know, and why. The
/// directions are those of `free_directions`, taken at the estimates that `trajectory`
/// numbers, poses first.
///
/// For each direction the number of the measurement that claims most of it. What rows
/// claim of a direction n is the information nᵀ Hᵀ H n. `None` where all rows together
/// claim 1e-16 or less of what it would be if nothing cancelled: of the sum over all rows
/// h of (Σᵢ |hᵢ nᵢ|)². It does not matter whether a measurement is kept.
pub fn lost(
    window: Window,
    points: Vec<[usize; 2]>,
    trajectory: Vec<usize>,
    steps: Steps,
) -> Vec<Option<usize>> {
    let _ = (window, points, trajectory, steps);
    todo!("which direction do the rows claim to know, and which measurement says so?")
}

/// The rows H + D that claim nothing along any combination of the columns of `directions`,
/// with the least change D: what D e is on average, squared and summed, is as little as
/// can be for errors e of mean zero and of this covariance. The covariance is positive
/// definite, and the directions do not depend on one another.
pub fn restored(
    rows: DMatrix<f64>,
    directions: DMatrix<f64>,
    covariance: DMatrix<f64>,
) -> DMatrix<f64> {
    let _ = (rows, directions, covariance);
    todo!("rows that leave the directions free and change as little as can be")
}
