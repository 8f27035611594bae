//! Rotations: the exponential, the logarithm and the Jacobians between them.
//!
//! A rotation vector φ turns about its own direction by its length in radians.

use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::coefficients::{Turn, cotangent_remainder, cotangent_remainder_slope, slopes, turn};

// ANCHOR: hat
/// The skew-symmetric matrix of the cross product: `hat(a) * b` is a × b. See {eq:hat}.
pub fn hat(phi: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -phi.z, phi.y, phi.z, 0.0, -phi.x, -phi.y, phi.x, 0.0)
}

/// The vector of a skew-symmetric matrix, the inverse of [`hat`]. Of any other matrix it
/// takes the skew-symmetric part.
pub fn vee(matrix: &Matrix3<f64>) -> Vector3<f64> {
    let m = matrix;
    0.5 * Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12)
}
// ANCHOR_END: hat

// ANCHOR: exp
/// The rotation of a rotation vector, by the Rodrigues formula. Implements {eq:rodrigues}.
pub fn exp(phi: &Vector3<f64>) -> Rotation3<f64> {
    let turn = turn(phi.norm_squared());
    Rotation3::from_matrix_unchecked(hat_polynomial(phi, turn.sinc, turn.cosc))
}

/// The matrix I + a φ^ + b φ^ φ^, entry by entry: products of matrices take twice as long.
#[rustfmt::skip]
#[inline]
fn hat_polynomial(phi: &Vector3<f64>, a: f64, b: f64) -> Matrix3<f64> {
    let (x, y, z) = (a * phi.x, a * phi.y, a * phi.z);
    let (xx, yy, zz) = (b * phi.x * phi.x, b * phi.y * phi.y, b * phi.z * phi.z);
    let (xy, yz, zx) = (b * phi.x * phi.y, b * phi.y * phi.z, b * phi.z * phi.x);
    Matrix3::new(
        1.0 - (yy + zz), xy - z, zx + y,
        xy + z, 1.0 - (zz + xx), yz - x,
        zx - y, yz + x, 1.0 - (xx + yy),
    )
}
// ANCHOR_END: exp

// ANCHOR: log
/// The rotation vector of a rotation, with an angle of at most π: the inverse of [`exp`].
/// Implements {eq:so3-log}.
///
/// A matrix holds numbers near one to 1e-16 and no better. Near zero that does no harm,
/// since the angle stands in the small entries beside the diagonal, and the error is
/// relative to the vector, however short. Near π it bounds what can be known: the vector
/// is right to 1e-15, but within 1e-15 of a half turn it may come out as the one that
/// turns the other way round, which is the same rotation to the last digit.
pub fn log(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let r = rotation.matrix();
    // For a unit quaternion q = (w, x, y, z) this is the matrix 4 q qᵀ. Each of its
    // columns is a multiple of q; the one with the largest diagonal is the best of them.
    let skew = 2.0 * vee(r);
    let block = r + r.transpose() + Matrix3::from_diagonal_element(1.0 - r.trace());
    let mut outer = Matrix4::from_element(1.0 + r.trace());
    outer.fixed_view_mut::<3, 1>(1, 0).copy_from(&skew);
    outer.fixed_view_mut::<1, 3>(0, 1).copy_from(&skew.transpose());
    outer.fixed_view_mut::<3, 3>(1, 1).copy_from(&block);
    let best = outer.column(outer.diagonal().imax());
    log_of_multiple(&Quaternion::new(best[0], best[1], best[2], best[3]))
}
// ANCHOR_END: log

// ANCHOR: quaternion
/// The unit quaternion of a rotation vector.
pub fn exp_quaternion(phi: &Vector3<f64>) -> UnitQuaternion<f64> {
    let square = 0.25 * phi.norm_squared();
    let half = turn(square);
    let (cosine, imaginary) = (1.0 - square * half.cosc, 0.5 * half.sinc * phi);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, imaginary))
}

/// The rotation vector of a unit quaternion, with an angle of at most π: the inverse of
/// [`exp_quaternion`]. It is as accurate near π as near zero.
pub fn log_quaternion(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    log_of_multiple(rotation.quaternion())
}
// ANCHOR_END: quaternion

// ANCHOR: log_of_multiple
/// The rotation vector of any multiple of a unit quaternion. Implements {eq:so3-log}.
fn log_of_multiple(quaternion: &Quaternion<f64>) -> Vector3<f64> {
    // A quaternion and its negative are one rotation; w ≥ 0 is the shorter way round.
    let shorter = if quaternion.w < 0.0 { -quaternion } else { *quaternion };
    // Cosine and sine of half the angle, both times the same unknown factor.
    let (cosine, imaginary) = (shorter.w, shorter.imag());
    let sine = imaginary.norm();
    if sine == 0.0 {
        // The square of a vector below 1e-162 underflows; the vector itself does not.
        imaginary * (2.0 / cosine)
    } else {
        imaginary * (2.0 * sine.atan2(cosine) / sine)
    }
}
// ANCHOR_END: log_of_multiple

// ANCHOR: jacobians
/// The 3×3 left Jacobian: exp(φ + δ) = exp(J δ) exp(φ) to first order in δ.
/// Implements {eq:left-jacobian}.
pub fn left_jacobian(phi: &Vector3<f64>) -> Matrix3<f64> {
    let turn = turn(phi.norm_squared());
    hat_polynomial(phi, turn.cosc, turn.sinc_remainder)
}

/// The 3×3 right Jacobian: exp(φ + δ) = exp(φ) exp(J δ) to first order in δ.
/// Implements {eq:right-jacobian}.
pub fn right_jacobian(phi: &Vector3<f64>) -> Matrix3<f64> {
    let turn = turn(phi.norm_squared());
    hat_polynomial(phi, -turn.cosc, turn.sinc_remainder)
}
// ANCHOR_END: jacobians

// ANCHOR: exp_with_right_jacobian
/// [`exp`] and [`right_jacobian`] of one vector, in less time than two calls.
#[inline]
pub fn exp_with_right_jacobian(phi: &Vector3<f64>) -> (Rotation3<f64>, Matrix3<f64>) {
    let Turn { sinc, cosc, sinc_remainder } = turn(phi.norm_squared());
    let rotation = Rotation3::from_matrix_unchecked(hat_polynomial(phi, sinc, cosc));
    (rotation, hat_polynomial(phi, -cosc, sinc_remainder))
}
// ANCHOR_END: exp_with_right_jacobian

// ANCHOR: inverse_jacobians
/// The inverse of [`left_jacobian`]: log(exp(δ) exp(φ)) = φ + J⁻¹ δ to first order in δ.
/// There is none at an angle of 2π.
pub fn left_jacobian_inverse(phi: &Vector3<f64>) -> Matrix3<f64> {
    hat_polynomial(phi, -0.5, cotangent_remainder(phi.norm_squared()))
}

/// The inverse of [`right_jacobian`]: log(exp(φ) exp(δ)) = φ + J⁻¹ δ to first order in δ.
/// There is none at an angle of 2π. Implements {eq:right-jacobian-inverse}.
pub fn right_jacobian_inverse(phi: &Vector3<f64>) -> Matrix3<f64> {
    hat_polynomial(phi, 0.5, cotangent_remainder(phi.norm_squared()))
}
// ANCHOR_END: inverse_jacobians

// ANCHOR: jacobian_derivative
/// The derivative of [`left_jacobian`] at φ in the direction ρ, a 3×3 matrix.
/// Implements {eq:se3-corner}.
pub fn left_jacobian_derivative(phi: &Vector3<f64>, rho: &Vector3<f64>) -> Matrix3<f64> {
    let (square, along) = (phi.norm_squared(), phi.dot(rho));
    let (Turn { cosc, sinc_remainder, .. }, slopes) = (turn(square), slopes(square));
    let skew = cosc * rho + along * slopes.cosc * phi;
    let other = sinc_remainder * rho + 0.5 * along * slopes.sinc_remainder * phi;
    hat(&skew) + anticommutator(phi, &other)
}

/// a^ b^ + b^ a^, which is a bᵀ + b aᵀ − 2 a·b.
fn anticommutator(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    let (xx, yy, zz) = (a.x * b.x, a.y * b.y, a.z * b.z);
    let (xy, yz, zx) = (a.x * b.y + a.y * b.x, a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z);
    Matrix3::new(-2.0 * (yy + zz), xy, zx, xy, -2.0 * (zz + xx), yz, zx, yz, -2.0 * (xx + yy))
}
// ANCHOR_END: jacobian_derivative

/// The derivative of [`left_jacobian_inverse`] at φ in the direction ρ, a 3×3 matrix.
pub fn left_jacobian_inverse_derivative(phi: &Vector3<f64>, rho: &Vector3<f64>) -> Matrix3<f64> {
    let (square, along) = (phi.norm_squared(), phi.dot(rho));
    let other =
        cotangent_remainder(square) * rho + 0.5 * along * cotangent_remainder_slope(square) * phi;
    anticommutator(phi, &other) - 0.5 * hat(rho)
}

// ANCHOR: retract
/// The rotation, moved in the frame from which it takes coordinates: R exp(φ).
/// See {eq:retract}.
pub fn retract(rotation: &Rotation3<f64>, phi: &Vector3<f64>) -> Rotation3<f64> {
    rotation * exp(phi)
}

/// The rotation vector that [`retract`] needs to get from the first rotation to the
/// second: log(R₁ᵀ R₂). Its error is 1e-15 radians, since the product of two rotations
/// has lost what was smaller.
pub fn local(first: &Rotation3<f64>, second: &Rotation3<f64>) -> Vector3<f64> {
    log(&(first.transpose() * second))
}
// ANCHOR_END: retract
