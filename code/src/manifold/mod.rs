//! Rotations and rigid motions as points of a curved space, and the small vectors by
//! which an estimator moves on it.
//!
//! [`so3`] treats rotations, [`se3`] poses, [`se2`] poses in the plane. A tangent vector of a pose, a *twist*, is
//! ξ = (ρ, φ): translation first. A state is moved by `retract(x, δ) = x exp(δ)`, on the
//! right, so δ is written in the frame of the moving body; `local` undoes it. These are the
//! conventions of @sola2018.
//!
//! # Accuracy
//!
//! Every exponential, logarithm and Jacobian is accurate to 1e-14 at every angle from
//! 1e-300 to π: the largest error of an entry against the largest entry of the true
//! vector, matrix or 3×3 block of a 6×6 matrix. A small angle keeps its own digits: the
//! off-diagonal part of a rotation by 1e-200 is right to 1e-14 of that 1e-200. What a
//! logarithm can know near π is told at [`so3::log`].
//!
//! Exponentials and Jacobians hold beyond π too, with an error that grows like the angle,
//! and that of the inverse Jacobians like the inverse of the distance to their pole at 2π.
//! Angles above 1e154 give NaN, since their square overflows.
//!
//! NaN in gives NaN out. Nothing here panics or allocates.

pub(crate) mod coefficients;
pub mod se2;
pub mod se3;
pub mod so3;
