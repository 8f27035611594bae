//! One landmark: its equations, its 3×3 block, and its coupling to the rigs that see it.

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

use super::Camera;
use super::layout::{HELD, Sighting};
use super::reduced::{add_multiple, multiply_add};
use crate::least_squares::Kernel;

// ANCHOR: equations
/// The two equations of one sighting, whitened and weighted: `residual` plus `camera` times
/// the rig's small vector plus `point` times the landmark's move should be zero.
#[derive(Debug, Clone, Copy)]
pub struct Equations<const D: usize> {
    /// Row by row, the derivative of the residual by the camera.
    pub camera: [[f64; D]; 2],
    /// The derivative of the residual by the point.
    pub point: Matrix2x3<f64>,
    /// The predicted pixel minus the measured one.
    pub residual: Vector2<f64>,
}
// ANCHOR_END: equations

impl<const D: usize> Equations<D> {
    // ANCHOR: linearize
    /// Linearizes one sighting. One whose point has no pixel says nothing.
    #[inline(always)]
    pub fn new<C: Camera<D>>(
        camera: &C,
        point: &Vector3<f64>,
        sighting: &Sighting,
        huber: f64,
    ) -> Self {
        let Some(view) = camera.differentiate(point) else {
            let (point, residual) = (Matrix2x3::zeros(), Vector2::zeros());
            return Self { camera: [[0.0; D]; 2], point, residual };
        };
        let residual = sighting.inverse_sigma * (view.pixel - sighting.pixel);
        let root_weight = root_weight(&residual, huber);
        let scale = root_weight * sighting.inverse_sigma;
        let row = |i| std::array::from_fn(|axis| scale * view.by_camera[(i, axis)]);
        let camera = [row(0), row(1)];
        Self { camera, point: scale * view.by_point, residual: root_weight * residual }
    }
    // ANCHOR_END: linearize
}

// ANCHOR: cost
/// The cost of one sighting, infinite when the point has no pixel.
#[inline(always)]
pub fn cost<C: Camera<D>, const D: usize>(
    camera: &C,
    point: &Vector3<f64>,
    sighting: &Sighting,
    huber: f64,
) -> f64 {
    let Some(pixel) = camera.project(point) else { return f64::INFINITY };
    let residual = sighting.inverse_sigma * (pixel - sighting.pixel);
    let squared = residual.norm_squared();
    if squared <= huber * huber { 0.5 * squared } else { cost_beyond(huber, squared.sqrt()) }
}
// ANCHOR_END: cost

// ANCHOR: beyond
/// The root of the weight of a residual. Nearly all lie within the threshold and have a
/// weight of one. What the others need is kept apart, or the processor would compute the
/// root and the quotient for all of them before it chooses.
#[inline(always)]
fn root_weight(residual: &Vector2<f64>, huber: f64) -> f64 {
    let squared = residual.norm_squared();
    if squared <= huber * huber { 1.0 } else { root_weight_beyond(huber, squared.sqrt()) }
}

#[cold]
fn root_weight_beyond(huber: f64, norm: f64) -> f64 {
    Kernel::Huber(huber).weight(norm).sqrt()
}

#[cold]
fn cost_beyond(huber: f64, norm: f64) -> f64 {
    Kernel::Huber(huber).cost(norm)
}
// ANCHOR_END: beyond

// ANCHOR: point_block
/// The lower triangle of a landmark's 3×3 block, and the gradient of the cost by it, from
/// its sightings.
///
/// Implements the middle line of {eq:ba-blocks}.
#[inline(always)]
pub fn point_block<const D: usize>(equations: &[Equations<D>]) -> (Matrix3<f64>, Vector3<f64>) {
    let (mut block, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
    for Equations { point, residual, .. } in equations {
        for column in 0..3 {
            let (u, v) = (point[(0, column)], point[(1, column)]);
            let sum = multiply_add(v, residual.y, gradient[column]);
            gradient[column] = multiply_add(u, residual.x, sum);
            for row in column..3 {
                let sum = multiply_add(v, point[(1, row)], block[(row, column)]);
                block[(row, column)] = multiply_add(u, point[(0, row)], sum);
            }
        }
    }
    (block, gradient)
}
// ANCHOR_END: point_block

// ANCHOR: inverse_factor
/// The lower triangular M with M H Mᵀ = I, the inverse of the Cholesky factor of a 3×3
/// matrix H of which the lower triangle is read. `None` when a pivot is not above
/// `smallest` times its place on the diagonal.
#[inline(always)]
pub fn inverse_factor(h: &Matrix3<f64>, smallest: f64) -> Option<Matrix3<f64>> {
    let m11 = 1.0 / h.m11.sqrt();
    let (l21, l31) = (m11 * h.m21, m11 * h.m31);
    let second = h.m22 - l21 * l21;
    let m22 = 1.0 / second.sqrt();
    let l32 = m22 * (h.m32 - l31 * l21);
    let third = h.m33 - l31 * l31 - l32 * l32;
    let m33 = 1.0 / third.sqrt();
    let regular = h.m11 > 0.0 && second > smallest * h.m22 && third > smallest * h.m33;
    let m21 = -m22 * l21 * m11;
    let m31 = -m33 * (l31 * m11 + l32 * m21);
    let m32 = -m33 * l32 * m22;
    regular.then(|| Matrix3::new(m11, 0.0, 0.0, m21, m22, 0.0, m31, m32, m33))
}
// ANCHOR_END: inverse_factor

// ANCHOR: couple
/// The D×3 matrix U = Jᵀ Jₗ Mᵀ that couples a landmark to each of its rigs, summed over the
/// rig's sightings. It is a block of the Cholesky factor of the whole system.
///
/// Implements {eq:coupling-factor}.
#[inline(always)]
pub fn couple<const D: usize>(
    couplings: &mut [[[f64; D]; 3]],
    sightings: &[Sighting],
    equations: &[Equations<D>],
    inverse_factor: &Matrix3<f64>,
) {
    for (sighting, Equations { camera: [u, v], point, .. }) in sightings.iter().zip(equations) {
        if sighting.slot == HELD {
            continue;
        }
        let scaled = point * inverse_factor.transpose();
        let coupling = &mut couplings[sighting.slot as usize];
        for (column, scaled) in coupling.iter_mut().zip(scaled.column_iter()) {
            add_multiple(column, scaled[0], u);
            add_multiple(column, scaled[1], v);
        }
    }
}
// ANCHOR_END: couple
