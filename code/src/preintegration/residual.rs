//! Preintegrated readings against two states, and one bias against the next.

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

use super::{Deltas, Matrix9, Matrix9x6, Preintegrated, Vector9, correct_for_bias};
use crate::inertial::{AxisNoise, ImuBias, NavState};
use crate::least_squares::{WhiteningError, sqrt_information};
use crate::manifold::so3;

// ANCHOR: residual
/// What two states say about the interval between them less what the readings say, in the order
/// (φ, v, p), in radians, m/s and metres. Gravity, in the world in m/s², appears here and
/// nowhere in the deltas. It is the residual of @forster2017. Implements {eq:imu-residual}.
pub fn imu_residual(
    preintegrated: &Preintegrated,
    first: &NavState,
    second: &NavState,
    gravity: &Vector3<f64>,
    bias: &ImuBias,
) -> Vector9 {
    let measured = correct_for_bias(preintegrated, bias);
    let stated = stated(preintegrated.duration, first, second, gravity);
    let phi = so3::local(&measured.rotation, &stated.rotation);
    let (v, p) = (stated.velocity - measured.velocity, stated.position - measured.position);
    stack(&phi, &v, &p)
}

// ANCHOR_END: residual

// ANCHOR: stated
/// The deltas of two states that are `t` seconds apart. Implements {eq:deltas}.
fn stated(t: f64, first: &NavState, second: &NavState, gravity: &Vector3<f64>) -> Deltas {
    let body_from_world = first.world_from_body.inverse();
    let coasting = first.position + t * first.velocity + 0.5 * t * t * gravity;
    Deltas {
        rotation: body_from_world * second.world_from_body,
        velocity: body_from_world * (second.velocity - first.velocity - t * gravity),
        position: body_from_world * (second.position - coasting),
    }
}
// ANCHOR_END: stated

fn stack(phi: &Vector3<f64>, velocity: &Vector3<f64>, position: &Vector3<f64>) -> Vector9 {
    let mut stacked = Vector9::zeros();
    stacked.fixed_rows_mut::<3>(0).copy_from(phi);
    stacked.fixed_rows_mut::<3>(3).copy_from(velocity);
    stacked.fixed_rows_mut::<3>(6).copy_from(position);
    stacked
}

// ANCHOR: linearized
/// The residual of an interval and its derivatives by steps (φ, v, p) of both states, as
/// [`NavState`] retracts them, and by the bias, gyroscope first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizedImu {
    /// As [`imu_residual`] gives it.
    pub residual: Vector9,
    /// By the state at the beginning, 9×9.
    pub by_first: Matrix9,
    /// By the state at the end, 9×9.
    pub by_second: Matrix9,
    /// By the bias, 9×6.
    pub by_bias: Matrix9x6,
}
// ANCHOR_END: linearized

// ANCHOR: linearize
/// The residual of an interval and its Jacobians, not whitened: {eq:residual-by-first},
/// {eq:residual-by-second} and {eq:residual-by-bias}.
///
/// The arguments are those of [`imu_residual`].
pub fn linearize(
    preintegrated: &Preintegrated,
    first: &NavState,
    second: &NavState,
    gravity: &Vector3<f64>,
    bias: &ImuBias,
) -> LinearizedImu {
    let stated = stated(preintegrated.duration, first, second, gravity);
    let residual = imu_residual(preintegrated, first, second, gravity, bias);
    let phi = residual.fixed_rows::<3>(0).into();
    let inverse = so3::right_jacobian_inverse(&phi);
    let by_rotation = -inverse * stated.rotation.matrix().transpose();
    let body_from_world = first.world_from_body.matrix().transpose();
    LinearizedImu {
        residual,
        by_first: by_first(&stated, &by_rotation, &body_from_world, preintegrated.duration),
        by_second: by_second(&inverse, &body_from_world),
        by_bias: by_bias(preintegrated, bias, &phi),
    }
}
// ANCHOR_END: linearize

// ANCHOR: by_first
/// By the first state. Its rotation turns all three deltas; its velocity also carries it on for
/// the whole interval. Implements {eq:residual-by-first}.
fn by_first(
    stated: &Deltas,
    by_rotation: &Matrix3<f64>,
    body_from_world: &Matrix3<f64>,
    duration: f64,
) -> Matrix9 {
    let mut jacobian = Matrix9::zeros();
    let mut put = |row, column, block: &Matrix3<f64>| {
        jacobian.fixed_view_mut::<3, 3>(row, column).copy_from(block);
    };
    put(0, 0, by_rotation);
    put(3, 0, &so3::hat(&stated.velocity));
    put(6, 0, &so3::hat(&stated.position));
    put(3, 3, &-body_from_world);
    put(6, 3, &(-duration * body_from_world));
    put(6, 6, &-body_from_world);
    jacobian
}

// ANCHOR_END: by_first

// ANCHOR: by_second
/// By the second state, which each delta contains once. Implements {eq:residual-by-second}.
fn by_second(inverse: &Matrix3<f64>, body_from_world: &Matrix3<f64>) -> Matrix9 {
    let mut jacobian = Matrix9::zeros();
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(inverse);
    jacobian.fixed_view_mut::<3, 3>(3, 3).copy_from(body_from_world);
    jacobian.fixed_view_mut::<3, 3>(6, 6).copy_from(body_from_world);
    jacobian
}
// ANCHOR_END: by_second

// ANCHOR: by_bias
/// By the bias. The rotation is corrected by exp(J δ), and a further step of δ comes out of it
/// through the right Jacobian at J δ, then through that of the logarithm.
/// Implements {eq:residual-by-bias}.
fn by_bias(preintegrated: &Preintegrated, bias: &ImuBias, phi: &Vector3<f64>) -> Matrix9x6 {
    let by_gyro = preintegrated.bias_jacobian.fixed_view::<3, 3>(0, 0);
    let step = by_gyro * preintegrated.bias_step(bias).fixed_rows::<3>(0);
    let block = so3::left_jacobian_inverse(phi) * so3::right_jacobian(&step) * by_gyro;
    let mut jacobian = -preintegrated.bias_jacobian;
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&-block);
    jacobian
}
// ANCHOR_END: by_bias

/// The 9×3 derivative of the residual by the acceleration of free fall, for a first state: what fell
/// for an interval has −g t in its velocity and −½ g t² in its position.
pub fn by_gravity(duration: f64, first: &NavState) -> SMatrix<f64, 9, 3> {
    let body_from_world = first.world_from_body.matrix().transpose();
    let mut jacobian = SMatrix::<f64, 9, 3>::zeros();
    jacobian.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-duration * body_from_world));
    let fallen = -0.5 * duration * duration * body_from_world;
    jacobian.fixed_view_mut::<3, 3>(6, 0).copy_from(&fallen);
    jacobian
}

impl LinearizedImu {
    /// Residual and Jacobians times the matrix that whitens them, from
    /// [`Preintegrated::sqrt_information`].
    pub fn whitened(&self, sqrt_information: &Matrix9) -> Self {
        Self {
            residual: sqrt_information * self.residual,
            by_first: sqrt_information * self.by_first,
            by_second: sqrt_information * self.by_second,
            by_bias: sqrt_information * self.by_bias,
        }
    }
}

// ANCHOR: bias_walk
/// Ties the bias at the beginning of an interval to that at its end, by the random walk between.
/// Implements {eq:bias-walk-factor}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasWalk {
    /// Whitens the difference of two biases, 6×6.
    pub sqrt_information: Matrix6<f64>,
}

/// The whitened residual of two biases and its derivatives by them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizedBiasWalk {
    /// The second bias less the first, in standard deviations, gyroscope first.
    pub residual: Vector6<f64>,
    /// By the first bias, 6×6.
    pub by_first: Matrix6<f64>,
    /// By the second bias, 6×6.
    pub by_second: Matrix6<f64>,
}

// ANCHOR_END: bias_walk

impl BiasWalk {
    // ANCHOR: bias_walk_linearize
    /// The walk of the biases in an interval of `duration` seconds.
    ///
    /// # Errors
    ///
    /// [`WhiteningError`] when the interval has no length or a bias does not walk. A bias that
    /// stays constant is one variable, not two.
    pub fn new(noise: impl Into<AxisNoise>, duration: f64) -> Result<Self, WhiteningError> {
        Ok(Self { sqrt_information: sqrt_information(&noise.into().bias_walk(duration))? })
    }

    /// The whitened residual and its Jacobians.
    pub fn linearize(&self, first: &ImuBias, second: &ImuBias) -> LinearizedBiasWalk {
        LinearizedBiasWalk {
            residual: self.sqrt_information * (second.vector() - first.vector()),
            by_first: -self.sqrt_information,
            by_second: self.sqrt_information,
        }
    }
    // ANCHOR_END: bias_walk_linearize
}
