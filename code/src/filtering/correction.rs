//! The update of a Gaussian by a linear measurement, in three forms.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, RealField};
use thiserror::Error;

// ANCHOR: form
/// How the covariance after a measurement is computed. With exact numbers both are the same, and the
/// same as the square of what [`correct_root`] makes of its root.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// P − Wᵀ W, for W = L⁻¹ H P and S = L Lᵀ: the fewest operations, and symmetric. A difference,
    /// it can lose all digits, and then its sign.
    #[default]
    Difference,
    /// (I − K H) P (I − K H)ᵀ + K Kᵀ: a sum of squares, for any gain K. It is the form of Joseph,
    /// {eq:joseph-form}.
    Joseph,
}
// ANCHOR_END: form

/// What a measurement says of the errors of a Gaussian.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction<T = f64> {
    /// The mean of the error after the measurement: the step that corrects the estimates.
    pub step: DVector<T>,
    /// rᵀ S⁻¹ r, the normalized innovation squared. It is not divided by the number of rows.
    pub innovation: T,
}

/// Updates the covariance P of an error e by a whitened measurement r + H e + n, whose noise n has
/// the unit covariance: r is the residual at the estimate, prediction minus measurement, and H its
/// m×n derivative. Implements {eq:gain-update}.
///
/// # Errors
///
/// A [`CorrectionError`]; the covariance then stays as it was.
// ANCHOR: correct
pub fn correct<T: RealField + Copy>(
    covariance: &mut DMatrix<T>,
    jacobian: &DMatrix<T>,
    residual: &DVector<T>,
    form: Form,
) -> Result<Correction<T>, CorrectionError> {
    check(covariance, jacobian, residual)?;
    let seen = jacobian * &*covariance;
    let (lower, whitened) = whitened_innovation(jacobian, &seen, residual)?;
    let mut gain = seen;
    lower.solve_lower_triangular_mut(&mut gain);
    let step = -gain.tr_mul(&whitened);
    check_finite(step.as_slice())?;
    match form {
        Form::Joseph => *covariance = joseph(covariance, jacobian, &lower, gain),
        Form::Difference => covariance.gemm(-T::one(), &gain.transpose(), &gain, T::one()),
    }
    Ok(Correction { step, innovation: whitened.norm_squared() })
}
// ANCHOR_END: correct

// ANCHOR: joseph
/// (I − K H) P (I − K H)ᵀ + K Kᵀ, from L⁻¹ H P with S = L Lᵀ.
fn joseph<T: RealField + Copy>(
    covariance: &DMatrix<T>,
    jacobian: &DMatrix<T>,
    lower: &DMatrix<T>,
    mut gain: DMatrix<T>,
) -> DMatrix<T> {
    lower.tr_solve_lower_triangular_mut(&mut gain);
    let dimension = covariance.nrows();
    let left = DMatrix::identity(dimension, dimension) - gain.tr_mul(jacobian);
    let kept = &left * covariance * left.transpose();
    kept + gain.tr_mul(&gain)
}
// ANCHOR_END: joseph

/// rᵀ S⁻¹ r, the normalized innovation squared of the measurement that [`correct`] has, before
/// anything is corrected by it: what a gate asks for. It is not divided by the number of rows.
/// Implements {eq:innovation-cost}.
///
/// # Errors
///
/// A [`CorrectionError`].
// ANCHOR: innovation_squared
pub fn innovation_squared<T: RealField + Copy>(
    covariance: &DMatrix<T>,
    jacobian: &DMatrix<T>,
    residual: &DVector<T>,
) -> Result<T, CorrectionError> {
    check(covariance, jacobian, residual)?;
    let (_, whitened) = whitened_innovation(jacobian, &(jacobian * covariance), residual)?;
    Ok(whitened.norm_squared())
}
// ANCHOR_END: innovation_squared

/// The lower root L of S = H P Hᵀ + I, from H and H P, and L⁻¹ r.
fn whitened_innovation<T: RealField + Copy>(
    jacobian: &DMatrix<T>,
    seen: &DMatrix<T>,
    residual: &DVector<T>,
) -> Result<(DMatrix<T>, DVector<T>), CorrectionError> {
    let mut innovation = seen * jacobian.transpose();
    (0..innovation.nrows()).for_each(|row| innovation[(row, row)] += T::one());
    let root: Option<Cholesky<T, Dyn>> = Cholesky::new(innovation);
    let lower = root.map(Cholesky::unpack).ok_or(CorrectionError::Covariance)?;
    let mut whitened = residual.clone();
    lower.solve_lower_triangular_mut(&mut whitened);
    Ok((lower, whitened))
}

/// Updates the upper root U of a covariance Uᵀ U. The rows (I 0) and (U Hᵀ, U) are turned into a
/// triangle, which holds the root of S, the gain, and the new root below it. Nothing is squared,
/// and nothing subtracted. Implements {eq:root-array}; [@kaminski1971] survey such forms.
///
/// # Errors
///
/// A [`CorrectionError`]; the root then stays as it was.
// ANCHOR: correct_root
pub fn correct_root<T: RealField + Copy>(
    root: &mut DMatrix<T>,
    jacobian: &DMatrix<T>,
    residual: &DVector<T>,
) -> Result<Correction<T>, CorrectionError> {
    check(root, jacobian, residual)?;
    let (rows, dimension) = jacobian.shape();
    let mut array = DMatrix::zeros(rows + dimension, rows + dimension);
    array.view_mut((0, 0), (rows, rows)).fill_with_identity();
    array.view_mut((rows, 0), (dimension, rows)).copy_from(&(&*root * jacobian.transpose()));
    array.view_mut((rows, rows), (dimension, dimension)).copy_from(root);
    let triangle = array.qr().unpack_r();
    let innovation = triangle.view((0, 0), (rows, rows));
    let mut whitened = residual.clone();
    if !innovation.tr_solve_upper_triangular_mut(&mut whitened) {
        return Err(CorrectionError::Covariance);
    }
    let step = -triangle.view((0, rows), (rows, dimension)).tr_mul(&whitened);
    check_finite(step.as_slice())?;
    root.copy_from(&triangle.view((rows, rows), (dimension, dimension)));
    Ok(Correction { step, innovation: whitened.norm_squared() })
}
// ANCHOR_END: correct_root

// ANCHOR: carry_root
/// Carries the upper root U of a covariance over a transition: the root of Φ Uᵀ U Φᵀ + Nᵀ N. `noise`
/// is N, a root of the covariance of what the transition adds.
///
/// # Errors
///
/// [`CorrectionError::Sizes`], [`CorrectionError::NotFinite`] with the row of transition or noise, and
/// [`CorrectionError::Covariance`] when the root has a number that is not finite.
pub fn carry_root<T: RealField + Copy>(
    root: &mut DMatrix<T>,
    transition: &DMatrix<T>,
    noise: &DMatrix<T>,
) -> Result<(), CorrectionError> {
    let dimension = root.nrows();
    check(root, transition, &DVector::zeros(dimension))?;
    check(root, noise, &DVector::zeros(noise.nrows()))?;
    let mut array = DMatrix::zeros(dimension + noise.nrows(), dimension);
    array.rows_mut(0, dimension).copy_from(&(&*root * transition.transpose()));
    array.rows_mut(dimension, noise.nrows()).copy_from(noise);
    let triangle = array.qr().unpack_r();
    check_finite(triangle.as_slice())?;
    root.copy_from(&triangle.rows(0, dimension));
    Ok(())
}
// ANCHOR_END: carry_root

fn check<T: RealField + Copy>(
    covariance: &DMatrix<T>,
    jacobian: &DMatrix<T>,
    residual: &DVector<T>,
) -> Result<(), CorrectionError> {
    let (rows, columns) = jacobian.shape();
    let dimension = covariance.nrows();
    if rows != residual.len() || columns != dimension || !covariance.is_square() {
        return Err(CorrectionError::Sizes { rows, columns, residual: residual.len(), dimension });
    }
    let finite = |entry: &T| entry.is_finite();
    let row =
        (0..rows).find(|row| !finite(&residual[*row]) || !jacobian.row(*row).iter().all(finite));
    row.map_or(Ok(()), |row| Err(CorrectionError::NotFinite { row }))
}

/// Whether the numbers of a covariance have been small enough to correct by it.
fn check_finite<T: RealField + Copy>(entries: &[T]) -> Result<(), CorrectionError> {
    let is_finite = entries.iter().all(|entry| entry.is_finite());
    is_finite.then_some(()).ok_or(CorrectionError::Covariance)
}

/// Why a measurement cannot correct anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum CorrectionError {
    /// Jacobian, residual and covariance do not belong together.
    #[error(
        "a Jacobian of {rows} rows and {columns} columns does not fit {residual} residuals and a \
         square covariance of {dimension} rows"
    )]
    Sizes {
        /// Rows of the Jacobian.
        rows: usize,
        /// Columns of the Jacobian.
        columns: usize,
        /// Numbers of the residual.
        residual: usize,
        /// Rows of the covariance.
        dimension: usize,
    },
    /// A row has a number that is not finite.
    #[error(
        "row {row} of the measurement, of the transition or of its noise has a number that is not finite; \
         leave the measurement out, or mend the number"
    )]
    NotFinite {
        /// The row, counted from zero.
        row: usize,
    },
    /// The covariance is none any more.
    #[error(
        "the covariance or its root is not positive definite or not finite; if it has lost its digits, \
         correct a root instead, or begin with smaller variances"
    )]
    Covariance,
}
