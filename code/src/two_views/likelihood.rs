//! Nonlinear triangulation: the most likely point, and how sure it is.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::triangulation::{TriangulationError, View, check, refuse_behind};
use crate::bundle_adjustment::Camera;
use crate::factors::{MovingCamera, PixelByCamera};
use crate::least_squares::{Kernel, Key, Method, Options, Problem, Solution};

// ANCHOR: triangulated
/// A point and what is known about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangulated {
    /// The most likely point, in world coordinates (metres).
    pub point: Vector3<f64>,
    /// Its 3×3 covariance, in square metres, to first order.
    pub covariance: Matrix3<f64>,
    /// By how much the estimate lies wrong on average, in metres, to leading order.
    pub bias: Vector3<f64>,
    /// Half the sum of squared whitened residuals.
    pub cost: f64,
    /// How many steps were tried.
    pub iterations: usize,
}
// ANCHOR_END: triangulated

const MOST_STEPS: usize = 50;
/// Beyond this the smallest eigenvalue of the information is mostly rounding.
const LARGEST_CONDITION: f64 = 1e12;

/// Nonlinear triangulation: the point at which the pixels of the views are most likely, from
/// `start`. For two views @hartley1997 find that point without a start.
///
/// Implements {eq:point-cost}, {eq:point-covariance} and {eq:point-bias}.
///
/// # Errors
///
/// [`TriangulationError`] when `start` is not in front of all views, there is no such point, or no steps
/// lead to it.
// ANCHOR: triangulate_nonlinear
pub fn triangulate_nonlinear(
    views: &[View],
    start: &Vector3<f64>,
) -> Result<Triangulated, TriangulationError> {
    check(views)?;
    refuse_behind(views, start)?;
    let (problem, landmark) = of_pixels(views, start);
    let too_large = |_| TriangulationError::TooLarge;
    let Solution { values, report } = problem.solve(&precise()).map_err(too_large)?;
    let information = problem.linearize(&values).map_err(too_large)?.hessian;
    let covariance = covariance(&information.fixed_view::<3, 3>(0, 0).into_owned())?;
    let iterations = report.iterations.len();
    if !report.stop.is_settled() {
        let last = report.iterations.iter().rfind(|step| step.accepted);
        let step = last.map_or(f64::INFINITY, |last| last.step_norm);
        return Err(TriangulationError::NotConverged { iterations, step });
    }
    let bias = bias(views, &values[landmark], &covariance);
    Ok(Triangulated { point: values[landmark], covariance, bias, cost: report.cost, iterations })
}
// ANCHOR_END: triangulate_nonlinear

// ANCHOR: of_pixels
/// The least-squares problem of one landmark and cameras that are held.
fn of_pixels(views: &[View], start: &Vector3<f64>) -> (Problem, Key<Vector3<f64>>) {
    let mut problem = Problem::new();
    let landmark = problem.add_variable(*start);
    for view in views {
        let camera = problem.add_variable(MovingCamera(view.posed()));
        let (pixel, inverse_sigma) = (view.pixel, 1.0 / view.sigma);
        let factor = PixelByCamera { camera, landmark, pixel, inverse_sigma };
        let added = problem.hold(camera).and_then(|()| problem.add_factor(factor, Kernel::Squared));
        // Not `expect`, which would carry how numbers are written into a program of a web page.
        let Ok(_) = added else { unreachable!("the variables are the problem's own") };
    }
    (problem, landmark)
}
// ANCHOR_END: of_pixels

/// Steps until a standard deviation is nothing to speak of.
fn precise() -> Options {
    Options {
        method: Method::LevenbergMarquardt { initial_damping: 1e-9 },
        max_iterations: MOST_STEPS,
        gradient_tolerance: 1e-9,
        step_tolerance: 1e-9,
        decrease_tolerance: 1e-15,
    }
}

// ANCHOR: point_covariance
/// The inverse of the information, unless there is not enough of it.
fn covariance(information: &Matrix3<f64>) -> Result<Matrix3<f64>, TriangulationError> {
    let eigenvalues = information.symmetric_eigenvalues();
    // Rounding may take the smallest one below zero: infinitely badly known is bad enough.
    let condition = eigenvalues.max() / eigenvalues.min().max(0.0);
    let inverse = information.try_inverse();
    let is_fixed = condition < LARGEST_CONDITION;
    inverse.filter(|_| is_fixed).ok_or(TriangulationError::Undetermined { condition })
}
// ANCHOR_END: point_covariance

// ANCHOR: bias
/// What the curvature of the projections does to the average of many estimates.
///
/// Implements {eq:point-bias}.
fn bias(views: &[View], point: &Vector3<f64>, covariance: &Matrix3<f64>) -> Vector3<f64> {
    let pull = |view: &View| {
        let seen = view.posed().differentiate(point)?;
        let shift = mean_pixel_shift(view, point, covariance);
        Some(seen.by_point.tr_mul(&shift) / view.sigma.powi(2))
    };
    -covariance * views.iter().filter_map(pull).sum::<Vector3<f64>>()
}
// ANCHOR_END: bias
// ANCHOR: mean_pixel_shift
/// By how many pixels the mean pixel of a cloud of points lies from the pixel of their mean:
/// half the trace of covariance times second derivatives.
fn mean_pixel_shift(view: &View, point: &Vector3<f64>, covariance: &Matrix3<f64>) -> Vector2<f64> {
    let rotation = view.camera_from_world.rotation.to_rotation_matrix();
    let spread = rotation.matrix() * covariance * rotation.matrix().transpose();
    let p = view.in_camera(point);
    let along = |axis: usize| (p[axis] / p.z * spread.m33 - spread[(axis, 2)]) / p.z.powi(2);
    Vector2::new(view.camera.fx * along(0), view.camera.fy * along(1))
}
// ANCHOR_END: mean_pixel_shift
