//! One landmark: its equations, its elimination and its way back.

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};

use super::Camera;
use super::layout::{HELD, Sighting};
use super::reduced::{add_multiple, multiply_add};
use super::standin::{huber_cost, huber_weight};

// ANCHOR: rows
/// The two equations of one sighting, whitened and weighted: camera times its small vector
/// plus point times its move equals error.
#[derive(Debug, Clone, Copy)]
pub struct Equations<const D: usize> {
    /// Row by row, the derivative of the pixel by the camera.
    pub camera: [[f64; D]; 2],
    /// The derivative of the pixel by the point.
    pub point: Matrix2x3<f64>,
    /// The pixel that was measured minus the one that is expected.
    pub error: Vector2<f64>,
}

impl<const D: usize> Equations<D> {
    /// Linearizes one sighting. One whose point has no pixel says nothing.
    #[inline(always)]
    pub fn new<C: Camera<D>>(
        camera: &C,
        point: &Vector3<f64>,
        sighting: &Sighting,
        huber: Option<f64>,
    ) -> Self {
        let Some(view) = camera.differentiate(point) else {
            let (point, error) = (Matrix2x3::zeros(), Vector2::zeros());
            return Self { camera: [[0.0; D]; 2], point, error };
        };
        let error = sighting.inv_sigma * (sighting.pixel - view.pixel);
        let root_weight = huber_weight(huber, error.norm_squared()).sqrt();
        let scale = root_weight * sighting.inv_sigma;
        let row = |i| std::array::from_fn(|axis| scale * view.by_camera[(i, axis)]);
        let camera = [row(0), row(1)];
        Self { camera, point: scale * view.by_point, error: root_weight * error }
    }
}

/// The cost of one sighting, infinite when the point has no pixel.
#[inline(always)]
pub fn cost<C: Camera<D>, const D: usize>(
    camera: &C,
    point: &Vector3<f64>,
    sighting: &Sighting,
    huber: Option<f64>,
) -> f64 {
    camera.project(point).map_or(f64::INFINITY, |pixel| {
        let error = sighting.inv_sigma * (sighting.pixel - pixel);
        huber_cost(huber, error.norm_squared())
    })
}
// ANCHOR_END: rows

// ANCHOR: eliminated
/// What elimination leaves of a landmark, enough to find its move when those of the cameras
/// are known.
#[derive(Debug, Clone, Copy)]
pub struct Eliminated {
    /// The lower triangular M with M H Mᵀ = I for the landmark's damped 3×3 block H.
    pub inverse_factor: Matrix3<f64>,
    /// M times the landmark's right-hand side.
    pub forward: Vector3<f64>,
    /// What damping added to the diagonal of H.
    pub damping: Vector3<f64>,
}

impl Eliminated {
    /// Nothing yet.
    pub fn empty() -> Self {
        let zero = Vector3::zeros();
        Self { inverse_factor: Matrix3::zeros(), forward: zero, damping: zero }
    }
}

/// The damped 3×3 block of a landmark and its right-hand side, from its sightings.
#[inline(always)]
pub fn point_block<const D: usize>(equations: &[Equations<D>]) -> (Matrix3<f64>, Vector3<f64>) {
    let (mut block, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
    for Equations { point, error, .. } in equations {
        for column in 0..3 {
            let (u, v) = (point[(0, column)], point[(1, column)]);
            gradient[column] = multiply_add(u, error.x, multiply_add(v, error.y, gradient[column]));
            for row in column..3 {
                let sum = multiply_add(v, point[(1, row)], block[(row, column)]);
                block[(row, column)] = multiply_add(u, point[(0, row)], sum);
            }
        }
    }
    (block, gradient)
}

/// The lower triangular M with M H Mᵀ = I, from the lower triangle of a positive definite
/// matrix H: the inverse of its Cholesky factor. `None` when a pivot is not above
/// `smallest` of the diagonal.
#[inline(always)]
pub fn inverse_factor(h: &Matrix3<f64>, smallest: f64) -> Option<Matrix3<f64>> {
    let a = 1.0 / h.m11.sqrt();
    let (l21, l31) = (a * h.m21, a * h.m31);
    let second = h.m22 - l21 * l21;
    let b = 1.0 / second.sqrt();
    let l32 = b * (h.m32 - l31 * l21);
    let third = h.m33 - l31 * l31 - l32 * l32;
    let c = 1.0 / third.sqrt();
    let found = h.m11 > 0.0 && second > smallest * h.m22 && third > smallest * h.m33;
    let (m21, m32) = (-b * l21 * a, -c * l32 * b);
    let m31 = -c * (l31 * a + l32 * m21);
    found.then(|| Matrix3::new(a, 0.0, 0.0, m21, b, 0.0, m31, m32, c))
}
// ANCHOR_END: eliminated

// ANCHOR: couplings
/// A landmark's coupling to each rig that sees it: the D×3 matrix U = Jᵀ Jₗ Mᵀ, summed
/// over the rig's sightings. It is a column of the Cholesky factor of the whole system.
#[inline(always)]
pub fn couple<const D: usize>(
    couplings: &mut [[[f64; D]; 3]],
    sightings: &[Sighting],
    equations: &[Equations<D>],
    inverse_factor: &Matrix3<f64>,
) {
    let mut last = HELD;
    for (sighting, Equations { camera: [u, v], point, .. }) in sightings.iter().zip(equations) {
        if sighting.slot == HELD {
            continue;
        }
        let coupling = &mut couplings[sighting.slot as usize];
        if sighting.slot != last {
            *coupling = [[0.0; D]; 3];
            last = sighting.slot;
        }
        let scaled = point * inverse_factor.transpose();
        for (column, scaled) in coupling.iter_mut().zip(scaled.column_iter()) {
            add_multiple(column, scaled[0], u);
            add_multiple(column, scaled[1], v);
        }
    }
}
// ANCHOR_END: couplings
