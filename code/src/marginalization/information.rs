//! Information form: Schur complements.

use nalgebra::{DMatrix, DMatrixView, DVector, RealField};

use super::pivots::{cast, double, factorize, factorize_blocks};
use super::{Blocks, MarginalizationError};

// ANCHOR: information
/// A Gaussian over named blocks in information form: the density of x is exp(−½ xᵀΛx + ηᵀx), up to a
/// factor, {eq:information-form}. It need not be determined in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Information<T> {
    blocks: Blocks,
    matrix: DMatrix<T>,
    vector: DVector<T>,
}
// ANCHOR_END: information

impl<T: RealField + Copy> Information<T> {
    /// The Gaussian with an information matrix Λ and an information vector η: Λ times its mean, or
    /// the negative gradient of the cost where x is zero.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Shape`], [`MarginalizationError::NotFinite`] and
    /// [`MarginalizationError::NotSymmetric`].
    pub fn new(
        blocks: Blocks,
        matrix: DMatrix<T>,
        vector: DVector<T>,
    ) -> Result<Self, MarginalizationError> {
        let (rows, columns, numbers) = (matrix.nrows(), matrix.ncols(), vector.len());
        let dimension = blocks.dimension();
        if [rows, columns, numbers] != [dimension; 3] {
            return Err(MarginalizationError::Shape { rows, columns, numbers, dimension });
        }
        check_finite(&matrix, &vector)?;
        let asymmetry = (&matrix - matrix.transpose()).amax();
        let rounding = T::default_epsilon().sqrt() * matrix.amax();
        if asymmetry > rounding {
            return Err(MarginalizationError::NotSymmetric { asymmetry: double(asymmetry) });
        }
        Ok(Self { blocks, matrix, vector })
    }

    /// One that is made of finite, symmetric parts of this size.
    pub(super) fn of_parts(blocks: Blocks, matrix: DMatrix<T>, vector: DVector<T>) -> Self {
        Self { blocks, matrix, vector }
    }

    /// The blocks, in the order of rows and columns.
    pub fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    /// The information matrix Λ.
    pub fn matrix(&self) -> &DMatrix<T> {
        &self.matrix
    }

    /// The information vector η.
    pub fn vector(&self) -> &DVector<T> {
        &self.vector
    }

    /// The block of the information matrix with the rows of one block and the columns of another.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Unknown`].
    pub fn between(
        &self,
        row: usize,
        column: usize,
    ) -> Result<DMatrixView<'_, T>, MarginalizationError> {
        let (rows, columns) = (self.blocks.columns_of(row)?, self.blocks.columns_of(column)?);
        Ok(self.matrix.view_range(rows, columns))
    }

    /// The mean, Λ⁻¹ η.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Singular`] and [`MarginalizationError::Indefinite`].
    pub fn mean(&self) -> Result<DVector<T>, MarginalizationError> {
        Ok(factorize_blocks(&self.matrix, &self.blocks)?.solve(&self.vector))
    }

    /// The covariance of all blocks, Λ⁻¹.
    ///
    /// # Errors
    ///
    /// As those of [`Information::mean`].
    pub fn covariance(&self) -> Result<DMatrix<T>, MarginalizationError> {
        Ok(factorize_blocks(&self.matrix, &self.blocks)?.inverse())
    }

    /// The same Gaussian with numbers of another precision.
    pub fn cast<U: RealField + Copy>(&self) -> Information<U> {
        let (matrix, vector) = (self.matrix.map(cast), self.vector.map(cast));
        Information { blocks: self.blocks.clone(), matrix, vector }
    }

    /// What is known of some blocks when all others are held at zero, in this order: rows and
    /// columns of the others are left out. With every name it is the same Gaussian in another order.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::NoneNamed`], [`MarginalizationError::Unknown`] and
    /// [`MarginalizationError::Repeated`].
    pub fn select(&self, names: &[usize]) -> Result<Self, MarginalizationError> {
        let (blocks, columns) = self.blocks.select(names)?;
        let matrix = self.matrix.select_rows(&columns).select_columns(&columns);
        Ok(Self { blocks, matrix, vector: self.vector.select_rows(&columns) })
    }

    /// Eliminates one block: what it said of its neighbours goes into their blocks, and its own rows
    /// and columns become zero. `diagonal` is what the matrix had before anything was eliminated.
    // ANCHOR: eliminate_block
    fn eliminate(
        &mut self,
        name: usize,
        diagonal: &DVector<T>,
    ) -> Result<(), MarginalizationError> {
        let Self { blocks, matrix, vector } = self;
        let own = blocks.columns_of(name)?;
        let is_coupled = |other: &usize| {
            !own.contains(other) && own.clone().any(|row| matrix[(row, *other)] != T::zero())
        };
        let reach: Vec<usize> = (0..matrix.ncols()).filter(is_coupled).collect();
        let block = matrix.view_range(own.clone(), own.clone()).into_owned();
        let diagonal = diagonal.rows_range(own.clone()).into_owned();
        let triangle = factorize(block, &diagonal, |_| name)?;
        // With Λ_αα = L Lᵀ, what is subtracted is the square of L⁻¹ Λ_αβ and symmetric as it stands.
        let mut half = matrix.rows_range(own.clone()).select_columns(&reach);
        let mut known = vector.rows_range(own.clone()).into_owned();
        triangle.l_dirty().solve_lower_triangular_unchecked_mut(&mut half);
        triangle.l_dirty().solve_lower_triangular_unchecked_mut(&mut known);
        self.subtract(&reach, &half, &known);
        self.matrix.rows_range_mut(own.clone()).fill(T::zero());
        self.matrix.columns_range_mut(own).fill(T::zero());
        Ok(())
    }
    // ANCHOR_END: eliminate_block

    /// Subtracts the square of some columns from the matrix, where these columns stand in it, and their
    /// products with a vector from the vector.
    fn subtract(&mut self, reach: &[usize], half: &DMatrix<T>, known: &DVector<T>) {
        for (at, &column) in reach.iter().enumerate() {
            self.vector[column] -= half.column(at).dot(known);
            for (below, &row) in reach.iter().enumerate().skip(at) {
                self.matrix[(row, column)] -= half.column(at).dot(&half.column(below));
                self.matrix[(column, row)] = self.matrix[(row, column)];
            }
        }
    }
}

// ANCHOR: marginalize
/// What is known of the other blocks when some are taken out: the Schur complements
/// Λ_ββ − Λ_βα Λ_αα⁻¹ Λ_αβ and η_β − Λ_βα Λ_αα⁻¹ η_α, by one Cholesky factorization for each block of
/// α. Mean and covariance of the survivors β stay what they were. Implements {eq:marg-schur}.
///
/// Blocks are eliminated in the order given. The result does not depend on it; the time does: those
/// with the fewest neighbours, landmarks, should come first.
///
/// # Errors
///
/// [`MarginalizationError::NoneNamed`], [`MarginalizationError::Unknown`],
/// [`MarginalizationError::Repeated`] and [`MarginalizationError::NothingLeft`] for the names;
/// [`MarginalizationError::Singular`] and [`MarginalizationError::Indefinite`] for the blocks.
pub fn marginalize<T: RealField + Copy>(
    information: &Information<T>,
    names: &[usize],
) -> Result<Information<T>, MarginalizationError> {
    let survivors = information.blocks.without(names)?;
    let mut left = information.clone();
    let diagonal = information.matrix.diagonal();
    for name in names {
        left.eliminate(*name, &diagonal)?;
    }
    left.select(&survivors)
}
// ANCHOR_END: marginalize

/// Whether all numbers of a matrix, and of the vector beside it, are finite.
pub(super) fn check_finite<T: RealField + Copy>(
    matrix: &DMatrix<T>,
    vector: &DVector<T>,
) -> Result<(), MarginalizationError> {
    let is_finite = |row: &usize| {
        vector[*row].is_finite() && matrix.row(*row).iter().all(|number| number.is_finite())
    };
    match (0..vector.len()).find(|row| !is_finite(row)) {
        Some(row) => Err(MarginalizationError::NotFinite { row }),
        None => Ok(()),
    }
}
