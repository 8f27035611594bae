//! Square-root form: orthogonal transformations.

use nalgebra::{DMatrix, DVector, RealField};

use super::information::check_finite;
use super::pivots::{cast, factorize_blocks};
use super::{Blocks, Information, MarginalizationError};
use crate::least_squares::{SparseRows, eliminate, eliminate_fronts};

// ANCHOR: square_root
/// A Gaussian over named blocks in square-root form: whitened residuals R x + d, and the density
/// exp(−½ ‖R x + d‖²) of x, up to a factor. It need not be determined in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct SquareRoot<T> {
    blocks: Blocks,
    root: DMatrix<T>,
    offset: DVector<T>,
}
// ANCHOR_END: square_root

impl<T: RealField + Copy> SquareRoot<T> {
    /// The Gaussian of rows with the root R, which has a column for each coordinate of each block, and
    /// the offset d.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Shape`] and [`MarginalizationError::NotFinite`].
    pub fn new(
        blocks: Blocks,
        root: DMatrix<T>,
        offset: DVector<T>,
    ) -> Result<Self, MarginalizationError> {
        let (rows, columns, numbers) = (root.nrows(), root.ncols(), offset.len());
        let dimension = blocks.dimension();
        if columns != dimension || rows != numbers {
            return Err(MarginalizationError::Shape { rows, columns, numbers, dimension });
        }
        check_finite(&root, &offset)?;
        Ok(Self { blocks, root, offset })
    }

    /// The blocks, in the order of the columns.
    pub fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    /// The root R.
    pub fn root(&self) -> &DMatrix<T> {
        &self.root
    }

    /// The offset d: the residuals where x is zero.
    pub fn offset(&self) -> &DVector<T> {
        &self.offset
    }

    // ANCHOR: forms
    /// The same Gaussian in information form: RᵀR and −Rᵀd. This squares the condition number.
    pub fn information(&self) -> Information<T> {
        let (matrix, vector) = (self.root.tr_mul(&self.root), -self.root.tr_mul(&self.offset));
        Information::of_parts(self.blocks.clone(), matrix, vector)
    }

    /// The triangular root of a Gaussian in information form: its Cholesky factor, transposed.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Singular`] and [`MarginalizationError::Indefinite`].
    pub fn of_information(information: &Information<T>) -> Result<Self, MarginalizationError> {
        let factor = factorize_blocks(information.matrix(), information.blocks())?;
        let mut offset = -information.vector();
        factor.l_dirty().solve_lower_triangular_unchecked_mut(&mut offset);
        let root = factor.unpack().transpose();
        Ok(Self { blocks: information.blocks().clone(), root, offset })
    }
    // ANCHOR_END: forms

    /// The same Gaussian with numbers of another precision.
    pub fn cast<U: RealField + Copy>(&self) -> SquareRoot<U> {
        let (root, offset) = (self.root.map(cast), self.offset.map(cast));
        SquareRoot { blocks: self.blocks.clone(), root, offset }
    }

    /// What is known of the other blocks when some are taken out: all rows that name one of these are
    /// turned until no more of them name it than it has coordinates, and those few are left out
    /// ([@demmel2021]). What stays is triangular. Implements {eq:marg-projection}.
    ///
    /// Blocks are eliminated in the order given. The result does not depend on it, except for signs of
    /// rows; the time does, see [`marginalize`](super::marginalize).
    ///
    /// # Errors
    ///
    /// As those of [`marginalize`](super::marginalize), but no block is indefinite, and the pivot of a
    /// singular one is zero.
    // ANCHOR: marginalize_root
    pub fn marginalize(&self, names: &[usize]) -> Result<Self, MarginalizationError> {
        let survivors = self.blocks.without(names)?;
        let (gone, first) = self.blocks.select(names)?;
        let (blocks, then) = self.blocks.select(&survivors)?;
        let sizes: Vec<usize> = gone.ranges().map(|range| range.len()).collect();
        let mut all = self.sparse_rows(&[first, then].concat());
        let numbers = 0..all.len();
        let (pieces, left) = eliminate_fronts(&mut all, numbers, &sizes);
        for (piece, range) in pieces.iter().zip(gone.ranges()) {
            if piece.own < range.len() {
                let name = gone.name_at(range.start);
                return Err(MarginalizationError::Singular { name, pivot: 0.0 });
            }
        }
        let (before, width) = (gone.dimension(), blocks.dimension());
        let mut rows = DMatrix::zeros(left.len(), width + 1);
        for (at, number) in left.into_iter().enumerate() {
            let entries = all.row(number).iter();
            entries.for_each(|(column, slope)| rows[(at, column - before)] = *slope);
        }
        // A last row, in which nothing but a residual stands, is a constant.
        let (rows, _) = eliminate(rows, width);
        let offset = rows.column(width).into_owned();
        Ok(Self { blocks, root: rows.remove_column(width), offset })
    }
    // ANCHOR_END: marginalize_root

    /// The rows with their columns in this order, and behind them the residual.
    fn sparse_rows(&self, order: &[usize]) -> SparseRows<T> {
        let mut rows = SparseRows::default();
        for number in 0..self.root.nrows() {
            let slopes = order.iter().map(|column| self.root[(number, *column)]);
            let row = slopes.chain([self.offset[number]]).enumerate();
            rows.push(row.filter(|(_, slope)| *slope != T::zero()));
        }
        rows
    }

    /// The Gaussian with some of its rows alone.
    pub(super) fn with_rows(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.root.nrows()).filter(|row| keep(*row)).collect();
        let (root, offset) = (self.root.select_rows(&kept), self.offset.select_rows(&kept));
        Self { blocks: self.blocks.clone(), root, offset }
    }

    /// The Gaussian in which all blocks but some, in this order, are held at zero.
    ///
    /// # Errors
    ///
    /// As those of [`Information::select`].
    pub fn select(&self, names: &[usize]) -> Result<Self, MarginalizationError> {
        let (blocks, columns) = self.blocks.select(names)?;
        Ok(Self { blocks, root: self.root.select_columns(&columns), offset: self.offset.clone() })
    }
}
