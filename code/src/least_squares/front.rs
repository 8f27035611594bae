//! A dense symmetric matrix on a few columns, and the elimination of the first of them.

use nalgebra::{DMatrix, DMatrixView};

use super::elimination_tree::Node;

// ANCHOR: eliminate
/// Eliminates the first columns of a front: of the matrix [H g; gᵀ c], whose lower triangle is given
/// by columns, each `order` numbers long. In their place comes the Cholesky factor of their part,
/// with the rows below divided by it, and in the rest what they leave of the others: the Schur
/// complement, its gradient and its constant.
///
/// # Errors
///
/// The first column whose pivot is not above its entry of `smallest`.
#[inline(always)]
pub fn eliminate(
    front: &mut [f64],
    order: usize,
    columns: usize,
    smallest: &[f64],
) -> Result<(), usize> {
    for column in 0..columns {
        let (done, rest) = front.split_at_mut(column * order);
        let own = &mut rest[column..order];
        subtract_products(done, order, column, own);
        let pivot = own[0];
        if pivot.is_nan() || pivot <= smallest[column] {
            return Err(column);
        }
        let reciprocal = 1.0 / pivot.sqrt();
        own.iter_mut().for_each(|entry| *entry *= reciprocal);
    }
    let (done, rest) = front.split_at_mut(columns * order);
    for (pair, row) in rest.chunks_mut(2 * order).zip((columns..).step_by(2)) {
        subtract_from_pair(done, order, row, pair);
    }
    Ok(())
}
// ANCHOR_END: eliminate

// ANCHOR: subtract_products
/// Subtracts from a column, of which the part from `row` on is given, its products with columns that
/// have been eliminated.
#[inline(always)]
fn subtract_products(done: &[f64], order: usize, row: usize, column: &mut [f64]) {
    for one in done.chunks_exact(order) {
        let part = &one[row..][..column.len()];
        let factor = part[0];
        column.iter_mut().zip(part).for_each(|(entry, other)| *entry -= factor * other);
    }
}

/// The same for two columns that stand side by side, the first of which is that of `row`: four
/// eliminated columns at a time, so that nothing is loaded and stored more often than it must be.
#[inline(always)]
fn subtract_from_pair(done: &[f64], order: usize, row: usize, pair: &mut [f64]) {
    let (first, second) = pair.split_at_mut(order);
    if second.is_empty() {
        return subtract_products(done, order, row, &mut first[row..]);
    }
    let len = order - row - 1;
    let (diagonal, first) = first[row..].split_at_mut(1);
    let (first, second) = (&mut first[..len], &mut second[row + 1..][..len]);
    let mut fours = done.chunks_exact(4 * order);
    for four in &mut fours {
        let [a, b, c, d] = [0, 1, 2, 3].map(|which| &four[which * order + row..][..len + 1]);
        let (by, next) = ([a[0], b[0], c[0], d[0]], [a[1], b[1], c[1], d[1]]);
        diagonal[0] -= by.iter().map(|factor| factor * factor).sum::<f64>();
        let [a, b, c, d] = [&a[1..], &b[1..], &c[1..], &d[1..]];
        for at in 0..len {
            let others = [a[at], b[at], c[at], d[at]];
            let product = |by: &[f64; 4]| {
                (by[0] * others[0] + by[1] * others[1]) + (by[2] * others[2] + by[3] * others[3])
            };
            first[at] -= product(&by);
            second[at] -= product(&next);
        }
    }
    let left = fours.remainder();
    subtract_products(left, order, row, diagonal);
    for one in left.chunks_exact(order) {
        let (by, next, others) = (one[row], one[row + 1], &one[row + 1..][..len]);
        for at in 0..len {
            first[at] -= by * others[at];
            second[at] -= next * others[at];
        }
    }
}
// ANCHOR_END: subtract_products

/// Adds what an eliminated front has left to the front that takes it, which is cleared first when
/// nothing has been added yet.
#[inline(always)]
pub fn add_rest(
    front: &[f64],
    order: usize,
    places: &[usize],
    (into, into_order): (&mut [f64], usize),
    is_first: bool,
) {
    if is_first {
        into[..into_order * into_order].fill(0.0);
    }
    let eliminated = order - places.len();
    for (at, place) in places.iter().enumerate() {
        let column = &front[(eliminated + at) * order + eliminated..][..places.len()];
        let sums = &mut into[place * into_order..(place + 1) * into_order];
        for (below, entry) in places[at..].iter().zip(&column[at..]) {
            sums[*below] += entry;
        }
    }
}

// ANCHOR: solve_transposed
/// The step of a front's own columns, when that of the rest is known, from its columns of the
/// factor and the eliminated right-hand side in their last row. Returns that side's square.
pub fn solve_transposed(factor: &[f64], node: &Node, step: &mut [f64]) -> f64 {
    let mut square = 0.0;
    for (place, column) in node.own.clone().enumerate().rev() {
        let below = &factor[place * (node.width() + 1)..][..node.width() + 1];
        let right = below[node.width()];
        let known: f64 = node.columns().zip(below).skip(place + 1).map(|(c, l)| l * step[c]).sum();
        step[column] = -(right + known) / below[place];
        square += right * right;
    }
    square
}
// ANCHOR_END: solve_transposed

// ANCHOR: covariance_of_front
/// The covariance of all columns of a front, from its columns of the factor and the covariance of
/// the rest.
///
/// With the factor's parts L and M, above and below, and W = M L⁻¹, the step of the own columns is
/// an error of covariance L⁻ᵀ L⁻¹, less Wᵀ times the step of the rest.
pub fn covariance_of_front(factor: &[f64], own: usize, rest: DMatrix<f64>) -> DMatrix<f64> {
    let width = own + rest.nrows();
    let factor = DMatrixView::from_slice(factor, width + 1, own);
    let identity = DMatrix::identity(own, own);
    let inverse = factor.rows(0, own).solve_lower_triangular(&identity);
    let inverse = inverse.unwrap_or_else(|| DMatrix::repeat(own, own, f64::NAN));
    let w = factor.rows(own, rest.nrows()) * &inverse;
    let cross = -(&rest * &w);
    let mut covariance = DMatrix::zeros(width, width);
    let own_part = inverse.tr_mul(&inverse) - w.tr_mul(&cross);
    covariance.view_mut((0, 0), (own, own)).copy_from(&own_part);
    covariance.view_mut((own, 0), (width - own, own)).copy_from(&cross);
    covariance.view_mut((0, own), (own, width - own)).copy_from(&cross.transpose());
    covariance.view_mut((own, own), (width - own, width - own)).copy_from(&rest);
    covariance
}
// ANCHOR_END: covariance_of_front
