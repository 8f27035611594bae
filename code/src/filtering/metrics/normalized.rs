//! Errors divided by what their covariances promise.

use nalgebra::allocator::Allocator;
use nalgebra::{DefaultAllocator, Dim, Matrix, SMatrix, Storage, Vector};
use thiserror::Error;

use super::{StateError, attitude_in_world};
use crate::inertial::NavState;

// ANCHOR: nees
/// The normalized estimation error squared of an error e of d numbers with the covariance P, divided
/// by its dimension: eᵀ P⁻¹ e / d. Its mean is one when P is the covariance of the error.
///
/// Not everybody divides. Divided, errors of different dimensions are compared with the same number.
///
/// # Errors
///
/// [`NeesError`] when sizes differ, and when P is not finite, symmetric and positive definite.
pub fn nees<D: Dim>(
    error: &Vector<f64, D, impl Storage<f64, D>>,
    covariance: &Matrix<f64, D, D, impl Storage<f64, D, D>>,
) -> Result<f64, NeesError>
where
    DefaultAllocator: Allocator<D> + Allocator<D, D>,
{
    check(error, covariance)?;
    let factor = covariance.clone_owned().cholesky().ok_or(NeesError::NotPositiveDefinite)?;
    // With P = L Lᵀ the quotient is the square of L⁻¹ e.
    let whitened = factor.l_dirty().solve_lower_triangular(error);
    let square = whitened.ok_or(NeesError::NotPositiveDefinite)?.norm_squared();
    Ok(square / error.len() as f64)
}
// ANCHOR_END: nees

// ANCHOR: nis
/// The normalized innovation squared, divided by its dimension: the same quotient for an innovation,
/// the measurement less its prediction, and the covariance S that the filter expects of it.
///
/// It needs no truth, so a real flight has it too. Innovations of a consistent filter do not depend
/// on one another from step to step, as errors of the state do: those of one run may be pooled.
/// When their dimensions differ, the mean is taken of νᵀ S⁻¹ ν over the sum of the dimensions.
///
/// # Errors
///
/// Those of [`nees`].
pub fn nis<D: Dim>(
    innovation: &Vector<f64, D, impl Storage<f64, D>>,
    covariance: &Matrix<f64, D, D, impl Storage<f64, D, D>>,
) -> Result<f64, NeesError>
where
    DefaultAllocator: Allocator<D> + Allocator<D, D>,
{
    nees(innovation, covariance)
}
// ANCHOR_END: nis

fn check<D: Dim>(
    error: &Vector<f64, D, impl Storage<f64, D>>,
    covariance: &Matrix<f64, D, D, impl Storage<f64, D, D>>,
) -> Result<(), NeesError>
where
    DefaultAllocator: Allocator<D> + Allocator<D, D>,
{
    let (rows, columns) = covariance.shape();
    if error.is_empty() {
        return Err(NeesError::Empty);
    }
    if [rows, columns] != [error.len(); 2] {
        return Err(NeesError::Sizes { error: error.len(), rows, columns });
    }
    if !error.iter().chain(covariance.iter()).all(|entry| entry.is_finite()) {
        return Err(NeesError::NotFinite);
    }
    let asymmetry = (covariance - covariance.transpose()).amax();
    if asymmetry > 1e-9 * covariance.amax() {
        return Err(NeesError::NotSymmetric { asymmetry });
    }
    Ok(())
}

/// The [`nees`] of the parts of a state, each by its own block of the covariance: what the sensors
/// cannot see and what they can are told apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockNees {
    /// Of the rotation about the vertical, one number.
    pub yaw: f64,
    /// Of the rotation about horizontal axes, two numbers.
    pub tilt: f64,
    /// Three numbers.
    pub velocity: f64,
    /// Three numbers.
    pub position: f64,
}

impl BlockNees {
    // ANCHOR: block_nees
    /// Of an estimate whose step (φ, v, p), as [`NavState`] retracts it, has this covariance.
    ///
    /// φ is written in the body, R = R̂ exp(φ^). Yaw and tilt are coordinates of R̂ φ, the same turn
    /// in the world, whose covariance is that of [`attitude_in_world`].
    ///
    /// # Errors
    ///
    /// Those of [`nees`].
    pub fn of(
        estimate: &NavState,
        truth: &NavState,
        covariance: &SMatrix<f64, 9, 9>,
    ) -> Result<Self, NeesError> {
        let StateError { rotation, velocity, position } = StateError::between(estimate, truth);
        let block = |at: usize| covariance.fixed_view::<3, 3>(at, at);
        let turn = attitude_in_world(estimate, &block(0));
        Ok(Self {
            yaw: nees(&rotation.fixed_rows::<1>(2), &turn.fixed_view::<1, 1>(2, 2))?,
            tilt: nees(&rotation.fixed_rows::<2>(0), &turn.fixed_view::<2, 2>(0, 0))?,
            velocity: nees(&velocity, &block(3))?,
            position: nees(&position, &block(6))?,
        })
    }
    // ANCHOR_END: block_nees
}

/// Why an error cannot be divided by a covariance.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NeesError {
    /// There is no number in the error.
    #[error("the error has no numbers; give at least one")]
    Empty,
    /// The covariance is that of something else.
    #[error(
        "an error of {error} numbers has a covariance of {error} rows and columns, and this one has \
         {rows} and {columns}; give the block that belongs to the error"
    )]
    Sizes {
        /// Numbers of the error.
        error: usize,
        /// Of the covariance.
        rows: usize,
        /// Of the covariance.
        columns: usize,
    },
    /// A number is NaN or infinite.
    #[error(
        "the error or its covariance has an entry that is not finite; the estimator has diverged, \
         so count the run as a failure"
    )]
    NotFinite,
    /// The covariance differs from its transpose.
    #[error("the covariance differs from its transpose by {asymmetry}; symmetrize it")]
    NotSymmetric {
        /// The largest difference.
        asymmetry: f64,
    },
    /// Some direction has no variance, or a negative one.
    #[error(
        "the covariance is not positive definite; leave out what is known exactly, and if nothing \
         is, the estimator's covariance has lost its digits"
    )]
    NotPositiveDefinite,
}
