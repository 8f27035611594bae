//! Poses: the exponential, the logarithm, the Jacobians between them and the adjoint.
//!
//! A twist ξ = (ρ, φ) holds a translation in metres and then a rotation vector in
//! radians, and so do the rows and columns of the 6×6 matrices: translation first.
//!
//! The 6×6 matrices all have the form A, B over 0, A. Such matrices add and multiply like
//! A + ε B with ε² = 0, so a power series in ad(ξ), with A = φ^ and B = ρ^, has the
//! same series in φ^ for its A and the derivative of that in the direction ρ for its B.
//!
//! A pose takes coordinates of one frame to another by [`transform`]. The operator `*` of
//! `nalgebra` does so for a `Point3` alone: it takes a `Vector3` for a direction, turns it and
//! leaves the translation out.

use nalgebra::{Isometry3, Matrix3, Matrix4, Matrix6, Vector3, Vector6};

use super::so3;

/// The translation ρ and the rotation vector φ of a twist.
fn parts(xi: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (xi.fixed_rows::<3>(0).into(), xi.fixed_rows::<3>(3).into())
}

// ANCHOR: transform
/// The coordinates of a point after a change of frames: R p + t, with the translation, which
/// `pose * point` would leave out.
pub fn transform(pose: &Isometry3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    pose.rotation * point + pose.translation.vector
}
// ANCHOR_END: transform

// ANCHOR: hat
/// The 4×4 matrix of a twist, whose matrix exponential is the pose. See {eq:twist}.
pub fn hat(xi: &Vector6<f64>) -> Matrix4<f64> {
    let (rho, phi) = parts(xi);
    let mut matrix = Matrix4::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::hat(&phi));
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&rho);
    matrix
}
// ANCHOR_END: hat

// ANCHOR: exp
/// The pose that is reached from the identity by following a twist for one unit of time.
/// Implements {eq:se3-exp}.
pub fn exp(xi: &Vector6<f64>) -> Isometry3<f64> {
    let (rho, phi) = parts(xi);
    let translation = so3::left_jacobian(&phi) * rho;
    Isometry3::from_parts(translation.into(), so3::exp_quaternion(&phi))
}

/// The twist of a pose, with an angle of at most π: the inverse of [`exp`].
pub fn log(pose: &Isometry3<f64>) -> Vector6<f64> {
    let phi = so3::log_quaternion(&pose.rotation);
    let rho = so3::left_jacobian_inverse(&phi) * pose.translation.vector;
    Vector6::new(rho.x, rho.y, rho.z, phi.x, phi.y, phi.z)
}
// ANCHOR_END: exp

// ANCHOR: adjoint
/// The 6×6 matrix that moves a twist to the other side of a pose:
/// T exp(ξ) = exp(Ad(T) ξ) T. Implements {eq:se3-adjoint}.
pub fn adjoint(pose: &Isometry3<f64>) -> Matrix6<f64> {
    let rotation = pose.rotation.to_rotation_matrix().into_inner();
    block_triangular(&rotation, &(so3::hat(&pose.translation.vector) * rotation))
}

/// The matrix A, B over 0, A.
fn block_triangular(diagonal: &Matrix3<f64>, corner: &Matrix3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(diagonal);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(corner);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(diagonal);
    matrix
}
// ANCHOR_END: adjoint

// ANCHOR: jacobians
/// The 6×6 left Jacobian: exp(ξ + δ) = exp(J δ) exp(ξ) to first order in δ.
///
/// Its corner, which @barfoot2014 write out as Q, is the derivative of the rotation's Jacobian
/// in the direction of the translation.
pub fn left_jacobian(xi: &Vector6<f64>) -> Matrix6<f64> {
    let (rho, phi) = parts(xi);
    block_triangular(&so3::left_jacobian(&phi), &so3::left_jacobian_derivative(&phi, &rho))
}

/// The 6×6 right Jacobian: exp(ξ + δ) = exp(ξ) exp(J δ) to first order in δ.
/// Implements {eq:se3-jacobian}.
pub fn right_jacobian(xi: &Vector6<f64>) -> Matrix6<f64> {
    left_jacobian(&-xi)
}
// ANCHOR_END: jacobians

// ANCHOR: inverse_jacobians
/// The inverse of [`left_jacobian`]: log(exp(δ) exp(ξ)) = ξ + J⁻¹ δ to first order in δ.
/// There is none at an angle of 2π.
pub fn left_jacobian_inverse(xi: &Vector6<f64>) -> Matrix6<f64> {
    let (rho, phi) = parts(xi);
    let corner = so3::left_jacobian_inverse_derivative(&phi, &rho);
    block_triangular(&so3::left_jacobian_inverse(&phi), &corner)
}

/// The inverse of [`right_jacobian`]: log(exp(ξ) exp(δ)) = ξ + J⁻¹ δ to first order in δ.
/// There is none at an angle of 2π.
pub fn right_jacobian_inverse(xi: &Vector6<f64>) -> Matrix6<f64> {
    left_jacobian_inverse(&-xi)
}
// ANCHOR_END: inverse_jacobians

// ANCHOR: retract
/// The pose moved by a twist in its own frame: T exp(ξ).
pub fn retract(pose: &Isometry3<f64>, xi: &Vector6<f64>) -> Isometry3<f64> {
    pose * exp(xi)
}

/// The twist that [`retract`] needs to get from the first pose to the second:
/// log(T₁⁻¹ T₂). As in [`so3::local`], what is smaller than 1e-15 radians is lost in the
/// product, and likewise what is smaller than 1e-15 of the translations.
pub fn local(first: &Isometry3<f64>, second: &Isometry3<f64>) -> Vector6<f64> {
    log(&first.inv_mul(second))
}
// ANCHOR_END: retract
