//! Nonlinear triangulation: the most likely point, and how sure it is.

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

use super::triangulation::{TriangulationError, View, check, is_finite};

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
    /// How many steps were made.
    pub iterations: usize,
}
// ANCHOR_END: triangulated

/// A step shorter than this many standard deviations is rest.
const REST: f64 = 1e-9;
const MOST_ITERATIONS: usize = 50;
/// How often a step that does not lower the cost is halved before the cost counts as flat.
const MOST_HALVINGS: usize = 30;
/// Beyond this the smallest eigenvalue of the information is mostly rounding.
const LARGEST_CONDITION: f64 = 1e12;

/// Nonlinear triangulation: the point at which the pixels of the views are most likely, by
/// Gauss-Newton steps from `start`. A step that does not lower the cost is halved. For two views
/// @hartley1997 find that point without a start.
///
/// Implements {eq:point-cost}, {eq:point-covariance} and {eq:point-bias}.
///
/// # Errors
///
/// [`TriangulationError`] when there is no such point, or no steps lead to it.
// ANCHOR: triangulate_nonlinear
pub fn triangulate_nonlinear(
    views: &[View],
    start: &Vector3<f64>,
) -> Result<Triangulated, TriangulationError> {
    check(views)?;
    let (mut point, mut here) = (*start, Linearized::at(views, start)?);
    let mut length = f64::INFINITY;
    for iterations in 0..MOST_ITERATIONS {
        let covariance = here.covariance()?;
        let step = -covariance * here.gradient;
        length = (-step.dot(&here.gradient)).max(0.0).sqrt();
        let lower = if length < REST { None } else { lower(views, &point, &step, here.cost) };
        let Some(next) = lower else {
            let bias = bias(views, &point, &covariance)?;
            return Ok(Triangulated { point, covariance, bias, cost: here.cost, iterations });
        };
        (point, here) = next;
    }
    Err(TriangulationError::NotConverged { iterations: MOST_ITERATIONS, step: length })
}
// ANCHOR_END: triangulate_nonlinear

/// The first point on the way of the step, halved again and again, that has a lower cost.
fn lower(
    views: &[View],
    point: &Vector3<f64>,
    step: &Vector3<f64>,
    cost: f64,
) -> Option<(Vector3<f64>, Linearized)> {
    let mut share = 1.0;
    for _ in 0..MOST_HALVINGS {
        let candidate = point + share * step;
        match Linearized::at(views, &candidate) {
            Ok(there) if there.cost < cost => return Some((candidate, there)),
            // Behind a camera, or higher.
            _ => share *= 0.5,
        }
    }
    None
}

/// The cost at a point with its derivatives, in units of the noise.
struct Linearized {
    cost: f64,
    gradient: Vector3<f64>,
    information: Matrix3<f64>,
}

impl Linearized {
    // ANCHOR: linearized
    fn at(views: &[View], point: &Vector3<f64>) -> Result<Self, TriangulationError> {
        let mut sum = Self { cost: 0.0, gradient: Vector3::zeros(), information: Matrix3::zeros() };
        for (index, view) in views.iter().enumerate() {
            let (pixel, jacobian) = predicted(index, view, point)?;
            let residual = (pixel - view.pixel) / view.sigma;
            let whitened = jacobian / view.sigma;
            sum.cost += 0.5 * residual.norm_squared();
            sum.gradient += whitened.tr_mul(&residual);
            sum.information += whitened.tr_mul(&whitened);
        }
        Ok(sum)
    }
    // ANCHOR_END: linearized

    // ANCHOR: point_covariance
    /// The inverse of the information, unless there is not enough of it.
    fn covariance(&self) -> Result<Matrix3<f64>, TriangulationError> {
        if !is_finite(&self.information) {
            return Err(TriangulationError::Undetermined { condition: f64::NAN });
        }
        let eigenvalues = self.information.symmetric_eigenvalues();
        // Rounding may take the smallest one below zero: infinitely badly known is bad enough.
        let condition = eigenvalues.max() / eigenvalues.min().max(0.0);
        let inverse = self.information.try_inverse();
        let is_fixed = condition < LARGEST_CONDITION;
        inverse.filter(|_| is_fixed).ok_or(TriangulationError::Undetermined { condition })
    }
    // ANCHOR_END: point_covariance
}

/// Where a view sees the point, and the 2×3 Jacobian by the point in the world.
fn predicted(
    index: usize,
    view: &View,
    point: &Vector3<f64>,
) -> Result<(Vector2<f64>, Matrix2x3<f64>), TriangulationError> {
    let in_camera = view.in_camera(point);
    let pixel = view.camera.project_cam(&in_camera);
    let by_camera_point = view.camera.projection_jacobian(&in_camera);
    let (Some(pixel), Some(by_camera_point)) = (pixel, by_camera_point) else {
        return Err(TriangulationError::Behind { view: index, depth: in_camera.z });
    };
    let rotation = view.camera_from_world.rotation.to_rotation_matrix();
    Ok((pixel, by_camera_point * rotation.matrix()))
}

// ANCHOR: bias
/// What the curvature of the projections does to the average of many estimates.
///
/// Implements {eq:point-bias}.
fn bias(
    views: &[View],
    point: &Vector3<f64>,
    covariance: &Matrix3<f64>,
) -> Result<Vector3<f64>, TriangulationError> {
    let mut pull = Vector3::zeros();
    for (index, view) in views.iter().enumerate() {
        let (_, jacobian) = predicted(index, view, point)?;
        let shift = mean_pixel_shift(view, point, covariance);
        pull += jacobian.tr_mul(&shift) / view.sigma.powi(2);
    }
    Ok(-covariance * pull)
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
