//! The columns of a Cholesky factor that are eliminated together, and what their elimination changes
//! in later ones.

use std::array::from_fn;
use std::ops::Range;

use nalgebra::{DMatrix, DMatrixView};

use super::elimination_tree::{Node, Tree};

// ANCHOR: factorize
/// Replaces a front's columns of the matrix [H g; gᵀ c] by those of its Cholesky factor. They are
/// given one after the other, each `order` numbers long, from the front's first row on; what stands
/// above the diagonal is void.
///
/// # Errors
///
/// The first column whose pivot is not above its entry of `smallest`.
#[inline(always)]
pub fn factorize(panel: &mut [f64], order: usize, smallest: &[f64]) -> Result<(), usize> {
    for (column, smallest) in smallest.iter().enumerate() {
        let (done, own) = panel.split_at_mut(column * order);
        let own = &mut own[column..order];
        subtract_products(own, done, order, column..order, column);
        let pivot = own[0];
        if pivot.is_nan() || pivot <= *smallest {
            return Err(column);
        }
        let reciprocal = 1.0 / pivot.sqrt();
        own.iter_mut().for_each(|entry| *entry *= reciprocal);
    }
    Ok(())
}
// ANCHOR_END: factorize

// ANCHOR: updates
/// What the elimination of each front changes: the columns that it leaves, by the fronts that eliminate
/// them.
#[derive(Debug, Clone, Default)]
pub struct Updates {
    all: Vec<Stored>,
    /// By front, where its updates end.
    ends: Vec<usize>,
    places: Vec<usize>,
    runs: Vec<Run>,
}

/// An update, with parts of the lists of all updates.
#[derive(Debug, Clone)]
struct Stored {
    front: usize,
    columns: Range<usize>,
    places: Range<usize>,
    runs: Range<usize>,
}

impl Updates {
    /// Finds those of other fronts, in the memory that is there.
    pub fn arrange(&mut self, tree: &Tree) {
        self.all.clear();
        self.ends.clear();
        self.places.clear();
        self.runs.clear();
        for node in &tree.nodes {
            let mut at = 0;
            while at < node.rest.len() {
                at = self.add(tree, node, at);
            }
            self.ends.push(self.all.len());
        }
    }

    /// Adds the one of the columns that a front leaves from this one on. Gives the next column, which
    /// another front eliminates.
    fn add(&mut self, tree: &Tree, node: &Node, at: usize) -> usize {
        let front = tree.front_of(node.rest[at]);
        let (later, first) = (&tree.nodes[front], node.own.len() + at);
        let end = node.rest.partition_point(|column| *column < later.own.end);
        let (place, run) = (self.places.len(), self.runs.len());
        let rows = later.places(&node.rest[at..]);
        for (row, to) in (first..).zip(rows.chain([later.width()])) {
            match self.runs[run..].last_mut() {
                Some(run) if run.continues(to) => run.from.end += 1,
                _ => self.runs.push(Run { from: row..row + 1, to }),
            }
            if row < first + end - at {
                self.places.push(to);
            }
        }
        let (places, runs) = (place..self.places.len(), run..self.runs.len());
        self.all.push(Stored { front, columns: first..first + end - at, places, runs });
        end
    }

    /// Those of a front.
    pub fn of(&self, front: usize) -> impl Iterator<Item = Update<'_>> {
        let begin = if front == 0 { 0 } else { self.ends[front - 1] };
        self.all[begin..self.ends[front]].iter().map(|stored| Update {
            front: stored.front,
            columns: stored.columns.clone(),
            places: &self.places[stored.places.clone()],
            runs: &self.runs[stored.runs.clone()],
        })
    }
}
// ANCHOR_END: updates

// ANCHOR: update
/// What the elimination of a front subtracts from the columns of a later one.
#[derive(Debug, Clone)]
pub struct Update<'a> {
    /// The later front.
    pub front: usize,
    /// Which rows of the front at hand are the columns to be changed, and their places there.
    columns: Range<usize>,
    places: &'a [usize],
    /// Rows, with those of the columns and everything below them.
    runs: &'a [Run],
}

/// Rows that follow each other here and there.
#[derive(Debug, Clone)]
struct Run {
    from: Range<usize>,
    to: usize,
}

impl Run {
    /// So many rows that those of a whole front stay in the fastest memory.
    const LONGEST: usize = 64;

    fn continues(&self, to: usize) -> bool {
        let len = self.from.len();
        len < Self::LONGEST && self.to + len == to
    }
}

impl Update<'_> {
    /// Subtracts the products of the front's eliminated columns from a later front's.
    #[inline(always)]
    pub fn apply(&self, (done, order): (&[f64], usize), (into, into_order): (&mut [f64], usize)) {
        for run in self.runs {
            let columns = self.columns.start..self.columns.end.min(run.from.end);
            let column = |place: usize| {
                place * into_order + run.to..place * into_order + run.to + run.from.len()
            };
            for (row, pair) in columns.step_by(2).zip(self.places.chunks(2)) {
                match *pair {
                    [first, next] if row + 1 < self.columns.end => {
                        let (left, right) = into.split_at_mut(next * into_order);
                        let (first, next) = (&mut left[column(first)], &mut right[column(0)]);
                        subtract_from_pair((first, next), done, order, run.from.clone(), row);
                    }
                    _ => subtract_products(
                        &mut into[column(pair[0])],
                        done,
                        order,
                        run.from.clone(),
                        row,
                    ),
                }
            }
        }
    }
}
// ANCHOR_END: update

// ANCHOR: subtract
/// Subtracts from a part of a column, that of these rows, its products with columns that have been
/// eliminated: four at a time, so that nothing is loaded and stored more often than it must be.
#[inline(always)]
fn subtract_products(
    column: &mut [f64],
    done: &[f64],
    order: usize,
    rows: Range<usize>,
    by: usize,
) {
    let mut fours = done.chunks_exact(4 * order);
    for four in &mut fours {
        subtract::<4>(column, four, order, &rows, by);
    }
    let left = fours.remainder();
    match left.len() / order {
        3 => subtract::<3>(column, left, order, &rows, by),
        2 => subtract::<2>(column, left, order, &rows, by),
        1 => subtract::<1>(column, left, order, &rows, by),
        _ => {}
    }
}

#[inline(always)]
fn subtract<const N: usize>(
    column: &mut [f64],
    done: &[f64],
    order: usize,
    rows: &Range<usize>,
    by: usize,
) {
    let others: [&[f64]; N] = from_fn(|k| &done[k * order..][rows.clone()]);
    let by: [f64; N] = from_fn(|k| done[k * order + by]);
    let len = rows.len();
    let (column, others) = (&mut column[..len], others.map(|other| &other[..len]));
    for at in 0..len {
        column[at] -= sum::<N>(from_fn(|k| by[k] * others[k][at]));
    }
}

/// The same for two columns, that of row `by` and the next one.
#[inline(always)]
fn subtract_from_pair(
    (first, next): (&mut [f64], &mut [f64]),
    done: &[f64],
    order: usize,
    rows: Range<usize>,
    by: usize,
) {
    let mut fours = done.chunks_exact(4 * order);
    for four in &mut fours {
        subtract_pair::<4>(first, next, four, order, &rows, by);
    }
    let left = fours.remainder();
    match left.len() / order {
        3 => subtract_pair::<3>(first, next, left, order, &rows, by),
        2 => subtract_pair::<2>(first, next, left, order, &rows, by),
        1 => subtract_pair::<1>(first, next, left, order, &rows, by),
        _ => {}
    }
}

#[inline(always)]
fn subtract_pair<const N: usize>(
    first: &mut [f64],
    next: &mut [f64],
    done: &[f64],
    order: usize,
    rows: &Range<usize>,
    by: usize,
) {
    let others: [&[f64]; N] = from_fn(|k| &done[k * order..][rows.clone()]);
    let [one, two]: [[f64; N]; 2] = [by, by + 1].map(|row| from_fn(|k| done[k * order + row]));
    let len = rows.len();
    let (first, next) = (&mut first[..len], &mut next[..len]);
    let others = others.map(|other| &other[..len]);
    for at in 0..len {
        let others: [f64; N] = from_fn(|k| others[k][at]);
        first[at] -= sum::<N>(from_fn(|k| one[k] * others[k]));
        next[at] -= sum::<N>(from_fn(|k| two[k] * others[k]));
    }
}

/// A sum of up to four numbers, of which none waits for more than one other.
#[inline(always)]
fn sum<const N: usize>(numbers: [f64; N]) -> f64 {
    match *numbers.as_slice() {
        [a, b, c, d] => (a + b) + (c + d),
        [a, b, c] => (a + b) + c,
        _ => numbers.iter().sum(),
    }
}
// ANCHOR_END: subtract

// ANCHOR: solve_transposed
/// The step of a front's own columns, when that of the rest is known, from its columns of the
/// factor and the eliminated right-hand side in their last row. Returns that side's square.
pub fn solve_transposed(factor: &[f64], node: &Node, step: &mut [f64]) -> f64 {
    let (mut square, own) = (0.0, node.own.len());
    for (place, column) in node.own.clone().enumerate().rev() {
        let below = &factor[place * (node.width() + 1)..][..node.width() + 1];
        let (right, nearer) = (below[node.width()], &step[column + 1..node.own.end]);
        let nearer = nearer.iter().zip(&below[place + 1..own]).map(|(step, entry)| entry * step);
        let rest = node.rest.iter().zip(&below[own..]).map(|(column, entry)| entry * step[*column]);
        let known = nearer.sum::<f64>() + rest.sum::<f64>();
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
