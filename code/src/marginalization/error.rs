//! What can be wrong with a Gaussian over blocks, or with what is asked of it.

use thiserror::Error;

use crate::least_squares::{ProblemError, SolveError};

/// Why blocks cannot be marginalized, compared or forgotten.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MarginalizationError {
    /// A block has no coordinates.
    #[error("block {name} has no coordinates; leave it out, or give its variable a dimension")]
    EmptyBlock {
        /// The block's name.
        name: usize,
    },
    /// There is nothing to speak of.
    #[error("no block was named; name at least one")]
    NoneNamed,
    /// A name stands twice.
    #[error("block {name} is named twice; name each block once")]
    Repeated {
        /// The name.
        name: usize,
    },
    /// A name is not one of the window.
    #[error("block {name} is none of the window's {blocks}; name one that is there")]
    Unknown {
        /// The name given.
        name: usize,
        /// How many blocks there are.
        blocks: usize,
    },
    /// Nothing would be left.
    #[error("all {blocks} blocks were named, and nothing would be left; keep at least one")]
    NothingLeft {
        /// How many blocks there are.
        blocks: usize,
    },
    /// A matrix does not fit the blocks.
    #[error(
        "a matrix of {rows} by {columns} with a vector of {numbers} does not fit blocks of {dimension} \
         coordinates together"
    )]
    Shape {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
        /// Numbers of the vector.
        numbers: usize,
        /// The dimension of all blocks.
        dimension: usize,
    },
    /// A number is NaN or infinite.
    #[error("row {row} has a number that is not finite; remove the factor that it comes from")]
    NotFinite {
        /// The row of the matrix or of the vector beside it.
        row: usize,
    },
    /// A matrix of information differs from its transpose.
    #[error("the information matrix differs from its transpose by {asymmetry:.1e}; symmetrize it")]
    NotSymmetric {
        /// The largest difference.
        asymmetry: f64,
    },
    /// A direction of a block is not determined, to rounding.
    #[error(
        "block {name} has a direction that nothing determines once the blocks before it are gone: \
         {pivot:.1e} of its own information is left; keep the block, or measure or hold that direction"
    )]
    Singular {
        /// The block's name.
        name: usize,
        /// What is left of its own information in that direction, as a fraction.
        pivot: f64,
    },
    /// A direction of a block has negative information, beyond rounding.
    #[error(
        "block {name} has negative information, {pivot:.1e} of its own, once the blocks before it are \
         gone, so this is no Gaussian; use the square-root form or more digits, or do not drop the link"
    )]
    Indefinite {
        /// The block's name.
        name: usize,
        /// What is left of its own information in that direction, as a fraction.
        pivot: f64,
    },
    /// Two Gaussians speak of different variables.
    #[error("the two Gaussians have different blocks; bring them into one order with `select`")]
    DifferentBlocks,
    /// Two blocks have no link that could be dropped.
    #[error(
        "blocks {first} and {second} are not linked; name two whose information block is not zero"
    )]
    NoLink {
        /// The name of one of them.
        first: usize,
        /// The name of the other one.
        second: usize,
    },
    /// Elimination would couple more survivors than allowed.
    #[error(
        "this would couple {pairs} pairs of survivors that were not coupled before, and {limit} are \
         allowed; forget some measurements of what leaves, or keep it"
    )]
    TooDense {
        /// How many new pairs there would be.
        pairs: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// The result is no factor of a problem.
    #[error(transparent)]
    Prior(#[from] ProblemError),
    /// A problem cannot be linearized.
    #[error(transparent)]
    Linearization(#[from] SolveError),
}
