//! Poses in the plane: the exponential, the logarithm, the inverse Jacobian and the adjoint.
//!
//! A twist ξ = (ρ, θ) holds a translation in metres and then an angle in radians, and so do the rows
//! and columns of the 3×3 matrices. All of it is what [`se3`](super::se3) says of poses that stay in
//! the plane z = 0.

use nalgebra::{Isometry2, Matrix2, Matrix3, UnitComplex, Vector2, Vector3};

use super::coefficients::{cotangent_remainder, cotangent_remainder_slope, turn};

/// A quarter turn to the left.
const LEFT: Matrix2<f64> = Matrix2::new(0.0, -1.0, 1.0, 0.0);

/// The pose that is reached from the identity by following a twist for one unit of time.
pub fn exp(xi: &Vector3<f64>) -> Isometry2<f64> {
    let (rho, angle) = (xi.xy(), xi.z);
    let turn = turn(angle * angle);
    let translation = turn.sinc * rho + angle * turn.cosc * (LEFT * rho);
    Isometry2::from_parts(translation.into(), UnitComplex::new(angle))
}

/// The twist of a pose, with an angle of at most π: the inverse of [`exp`].
pub fn log(pose: &Isometry2<f64>) -> Vector3<f64> {
    let (angle, t) = (pose.rotation.angle(), pose.translation.vector);
    let rho = half_cotangent(angle) * t - 0.5 * angle * (LEFT * t);
    Vector3::new(rho.x, rho.y, angle)
}

/// (θ/2) cot(θ/2).
fn half_cotangent(angle: f64) -> f64 {
    1.0 - angle * angle * cotangent_remainder(angle * angle)
}

/// The 3×3 matrix that moves a twist to the other side of a pose: T exp(ξ) = exp(Ad(T) ξ) T.
pub fn adjoint(pose: &Isometry2<f64>) -> Matrix3<f64> {
    let rotation = pose.rotation.to_rotation_matrix().into_inner();
    affine(&rotation, &(-(LEFT * pose.translation.vector)))
}

/// The matrix that takes log(T) to log(T exp(δ)) to first order in δ, from the twist ξ = log(T): the
/// inverse of the right Jacobian. There is none at an angle of 2π.
pub fn right_jacobian_inverse(xi: &Vector3<f64>) -> Matrix3<f64> {
    let (angle, square) = (xi.z, xi.z * xi.z);
    let pose = exp(xi);
    let t = pose.translation.vector;
    let half = half_cotangent(angle);
    let slope =
        -angle * (2.0 * cotangent_remainder(square) + square * cotangent_remainder_slope(square));
    let log = half * Matrix2::identity() - 0.5 * angle * LEFT;
    affine(&(log * pose.rotation.to_rotation_matrix().matrix()), &(slope * t - 0.5 * (LEFT * t)))
}

/// The matrix A, b over 0, 1.
fn affine(linear: &Matrix2<f64>, column: &Vector2<f64>) -> Matrix3<f64> {
    let mut matrix = Matrix3::identity();
    matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(linear);
    matrix.fixed_view_mut::<2, 1>(0, 2).copy_from(column);
    matrix
}

/// The pose moved by a twist in its own frame: T exp(ξ).
pub fn retract(pose: &Isometry2<f64>, xi: &Vector3<f64>) -> Isometry2<f64> {
    pose * exp(xi)
}

/// The twist that [`retract`] needs to get from the first pose to the second: log(T₁⁻¹ T₂).
pub fn local(first: &Isometry2<f64>, second: &Isometry2<f64>) -> Vector3<f64> {
    log(&first.inv_mul(second))
}
