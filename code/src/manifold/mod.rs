//! Rotations and rigid motions as points of a curved space, and the small vectors by
//! which an estimator moves on it.
//!
//! [`so3`] treats rotations, [`se3`] poses. A tangent vector of a pose, a *twist*, is
//! ξ = (ρ, φ): translation first. A state is moved by `retract(x, δ) = x exp(δ)`, on the
//! right, so δ is written in the frame of the moving body; `local` undoes it.
//!
//! # Accuracy
//!
//! Every function is accurate to 1e-14 at every angle from 1e-300 to π, measured as the
//! largest error of an entry against the norm of the true vector, matrix or 3×3 block of
//! a 6×6 matrix. Small angles keep their own digits: the off-diagonal part of a rotation
//! by 1e-200 is accurate to 1e-14 of that 1e-200. Above π the exponentials and Jacobians
//! go on to hold, the inverse Jacobians up to their pole at 2π; angles must stay below
//! 1e154, where their square overflows.
//!
//! NaN in gives NaN out. Nothing here panics or allocates.

mod coefficients;
pub mod se3;
pub mod so3;
