//! Making an information matrix sparse again by dropping links, in three ways. All keep the mean.

use nalgebra::{DMatrix, RealField};

use super::pivots::factorize_blocks;
use super::{Blocks, Information, MarginalizationError, marginalize};

/// The Gaussian of the same mean in whose information matrix two blocks have no link: their
/// off-diagonal blocks are zero, and all other numbers stay.
///
/// What is subtracted from the matrix has as many positive as negative eigenvalues, the rank of the link
/// of each. So some directions become better known than the measurements say, and as many others worse
/// known ({thm:link-balance}); which of them a variable's variance follows depends on the rest of the
/// graph, {eq:link-slope}. The result need not be a Gaussian at all.
///
/// # Errors
///
/// [`MarginalizationError::Unknown`], [`MarginalizationError::NoLink`], [`MarginalizationError::Singular`]
/// when a direction was free before, and [`MarginalizationError::Indefinite`] or
/// [`MarginalizationError::Singular`] when the result is no Gaussian.
// ANCHOR: zero_link
pub fn zero_link<T: RealField + Copy>(
    information: &Information<T>,
    first: usize,
    second: usize,
) -> Result<Information<T>, MarginalizationError> {
    check_link(information, first, second)?;
    let blocks = information.blocks();
    let (rows, columns) = (blocks.columns_of(first)?, blocks.columns_of(second)?);
    let mut matrix = information.matrix().clone();
    matrix.view_range_mut(rows.clone(), columns.clone()).fill(T::zero());
    matrix.view_range_mut(columns, rows).fill(T::zero());
    with_matrix(information, matrix)
}
// ANCHOR_END: zero_link

// ANCHOR: keep_marginals
/// The Gaussian of the same mean in which two blocks have no link, and that is nearest to the given one
/// in the divergence D(given‖it): p(a | rest) p(b, rest). Each of the two keeps its joint covariance with
/// all others, so no single block is claimed to be known better or worse than it is; what changes is how
/// the two vary together. All neighbours of either become coupled. Implements {eq:kept-marginals}.
///
/// # Errors
///
/// [`MarginalizationError::Unknown`], [`MarginalizationError::NoLink`], and
/// [`MarginalizationError::Singular`] or [`MarginalizationError::Indefinite`] when the given one is no
/// Gaussian.
pub fn keep_marginals<T: RealField + Copy>(
    information: &Information<T>,
    first: usize,
    second: usize,
) -> Result<Information<T>, MarginalizationError> {
    check_link(information, first, second)?;
    let mut matrix = DMatrix::zeros(information.matrix().nrows(), information.matrix().ncols());
    let blocks = information.blocks();
    add(&mut matrix, blocks, T::one(), &marginalize(information, &[first])?)?;
    add(&mut matrix, blocks, T::one(), &marginalize(information, &[second])?)?;
    if blocks.len() > 2 {
        add(&mut matrix, blocks, -T::one(), &marginalize(information, &[first, second])?)?;
    }
    with_matrix(information, matrix)
}
// ANCHOR_END: keep_marginals

/// The sparsification of the sparse extended information filter: cuts all links between a block x,
/// the robot, and some others, Y⁰. With Y⁺ those that stay linked with x, and Y⁻ the rest, it is
/// p(x | Y⁺, Y⁻ held) p(Y⁰, Y⁺, Y⁻), of which the information matrix is Λ¹ − Λ² + Λ³:
///
/// - Λ¹ is that of x and Y⁺ with Y⁻ held and Y⁰ marginalized,
/// - Λ² that of Y⁺ with Y⁻ held and x and Y⁰ marginalized,
/// - Λ³ that of all but x, with x marginalized.
///
/// The result is always a Gaussian, and all blocks but x keep their joint covariance. x does not: it
/// takes Y⁻ as known. Y⁺ and Y⁰ become coupled with each other. Implements
/// {eq:filter-sparsification} ([@thrun2004]).
///
/// # Errors
///
/// As those of [`keep_marginals`], and [`MarginalizationError::NoneNamed`] and
/// [`MarginalizationError::Repeated`].
// ANCHOR: sparsify
pub fn sparsify<T: RealField + Copy>(
    information: &Information<T>,
    robot: usize,
    cut: &[usize],
) -> Result<Information<T>, MarginalizationError> {
    let blocks = information.blocks();
    blocks.select(cut)?;
    cut.iter().try_for_each(|other| check_link(information, robot, *other))?;
    let is_linked = |other: &usize| check_link(information, robot, *other).is_ok();
    let kept: Vec<usize> =
        blocks.names().filter(|name| is_linked(name) && !cut.contains(name)).collect();
    let near = information.select(&[&[robot], cut, &kept[..]].concat())?;
    let mut matrix = DMatrix::zeros(information.matrix().nrows(), information.matrix().ncols());
    add(&mut matrix, blocks, T::one(), &marginalize(&near, cut)?)?;
    if !kept.is_empty() {
        let gone = [cut, &[robot]].concat();
        add(&mut matrix, blocks, -T::one(), &marginalize(&near, &gone)?)?;
    }
    add(&mut matrix, blocks, T::one(), &marginalize(information, &[robot])?)?;
    with_matrix(information, matrix)
}
// ANCHOR_END: sparsify

fn check_link<T: RealField + Copy>(
    information: &Information<T>,
    first: usize,
    second: usize,
) -> Result<(), MarginalizationError> {
    let is_linked = information.between(first, second)?.iter().any(|number| *number != T::zero());
    let no_link = MarginalizationError::NoLink { first, second };
    (first != second && is_linked).then_some(()).ok_or(no_link)
}

/// Adds a multiple of the information of some blocks to that of all.
fn add<T: RealField + Copy>(
    matrix: &mut DMatrix<T>,
    blocks: &Blocks,
    factor: T,
    part: &Information<T>,
) -> Result<(), MarginalizationError> {
    let names: Vec<usize> = part.blocks().names().collect();
    let (_, columns) = blocks.select(&names)?;
    for (from, &column) in columns.iter().enumerate() {
        for (row_from, &row) in columns.iter().enumerate() {
            matrix[(row, column)] += factor * part.matrix()[(row_from, from)];
        }
    }
    Ok(())
}

/// The Gaussian with another information matrix and the same mean.
fn with_matrix<T: RealField + Copy>(
    information: &Information<T>,
    matrix: DMatrix<T>,
) -> Result<Information<T>, MarginalizationError> {
    factorize_blocks(&matrix, information.blocks())?;
    let vector = &matrix * information.mean()?;
    Information::new(information.blocks().clone(), matrix, vector)
}
