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
/// The first column whose pivot is not above its entry of `smallest`. Of so many columns as `lifted`
/// says, from the first on, such a pivot becomes as large as that, or one where that is
/// zero; NaN is refused.
#[inline(always)]
pub fn factorize(
    panel: &mut [f64],
    order: usize,
    smallest: &[f64],
    lifted: usize,
) -> Result<(), usize> {
    for (block, smallest) in smallest.chunks(COLUMNS).enumerate() {
        let first = COLUMNS * block;
        let (done, own) = panel.split_at_mut(first * order);
        let starts: [usize; COLUMNS] = from_fn(|column| column * order + first);
        subtract_products(own, &starts[..smallest.len()], (done, order), first..order, first);
        let lifted = lifted.saturating_sub(first);
        factorize_block(own, order, first, (smallest, lifted)).map_err(|column| first + column)?;
    }
    Ok(())
}

/// The same for a few columns from which the products with all before them have been subtracted.
#[inline(always)]
fn factorize_block(
    panel: &mut [f64],
    order: usize,
    first: usize,
    (smallest, lifted): (&[f64], usize),
) -> Result<(), usize> {
    for (column, smallest) in smallest.iter().enumerate() {
        let (done, own) = panel.split_at_mut(column * order);
        let own = &mut own[first + column..order];
        for done in done.chunks_exact(order) {
            let done = &done[first + column..];
            let by = done[0];
            own.iter_mut().zip(done).for_each(|(entry, other)| *entry -= by * other);
        }
        let mut pivot = own[0];
        if pivot.is_nan() || pivot <= *smallest {
            if column >= lifted || pivot.is_nan() {
                return Err(column);
            }
            // What no factor sees is tied to nothing, and any pivot does.
            pivot = if *smallest > 0.0 { *smallest } else { 1.0 };
            own[0] = pivot;
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
    pub fn apply(&self, done: (&[f64], usize), (into, into_order): (&mut [f64], usize)) {
        for run in self.runs {
            let columns = self.columns.start..self.columns.end.min(run.from.end);
            let by = columns.clone().step_by(COLUMNS);
            for (by, places) in by.zip(self.places[..columns.len()].chunks(COLUMNS)) {
                let mut starts = [0; COLUMNS];
                for (start, place) in starts.iter_mut().zip(places) {
                    *start = place * into_order + run.to;
                }
                subtract_products(into, &starts[..places.len()], done, run.from.clone(), by);
            }
        }
    }
}
// ANCHOR_END: update

/// So many columns are changed at once: coordinates come in threes.
const COLUMNS: usize = 3;
/// So many rows are changed at once: all sums of them with the columns stay in registers.
const ROWS: usize = 12;

// ANCHOR: subtract
/// Subtracts from parts of some columns, which begin at `starts`, the products of these rows of a front
/// with as many others, from `by` on, summed over the columns that have been eliminated.
#[inline(always)]
fn subtract_products(
    into: &mut [f64],
    starts: &[usize],
    done: (&[f64], usize),
    rows: Range<usize>,
    by: usize,
) {
    if let Some(starts) = starts.as_array::<COLUMNS>() {
        return subtract_rows(into, *starts, done, rows, by);
    }
    for (start, by) in starts.iter().zip(by..) {
        subtract_rows(into, [*start], done, rows.clone(), by);
    }
}

/// The same, many rows at a time, then as many as there are coordinates, then one.
#[inline(always)]
fn subtract_rows<const C: usize>(
    into: &mut [f64],
    starts: [usize; C],
    done: (&[f64], usize),
    rows: Range<usize>,
    by: usize,
) {
    let (starts, rows) = subtract_tiles::<ROWS, C>(into, starts, done, rows, by);
    let (starts, rows) = subtract_tiles::<COLUMNS, C>(into, starts, done, rows, by);
    subtract_tiles::<1, C>(into, starts, done, rows, by);
}

/// The same for as many rows as whole tiles have. Gives the places of the others, and which they are.
#[inline(always)]
fn subtract_tiles<const R: usize, const C: usize>(
    into: &mut [f64],
    mut starts: [usize; C],
    done: (&[f64], usize),
    mut rows: Range<usize>,
    by: usize,
) -> ([usize; C], Range<usize>) {
    while rows.len() >= R {
        let sums = products::<R, C>(done, rows.start, by);
        for (start, sums) in starts.iter_mut().zip(sums) {
            let into = into[*start..].first_chunk_mut::<R>().expect("a column has these rows");
            *into = from_fn(|row| into[row] - sums[row]);
            *start += R;
        }
        rows.start += R;
    }
    (starts, rows)
}

/// The sums of products of rows and columns, from these on.
#[inline(always)]
fn products<const R: usize, const C: usize>(
    (done, order): (&[f64], usize),
    row: usize,
    by: usize,
) -> [[f64; R]; C] {
    let mut sums = [[0.0; R]; C];
    for column in done.chunks_exact(order) {
        let rows: &[f64; R] = column[row..].first_chunk().expect("a front has these rows");
        let by: &[f64; C] = column[by..].first_chunk().expect("a front has these rows");
        for (sums, by) in sums.iter_mut().zip(by) {
            sums.iter_mut().zip(rows).for_each(|(sum, entry)| *sum += by * entry);
        }
    }
    sums
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

/// Replaces numbers b, column by column, by L⁻¹ b, from all fronts of a factor L.
pub fn solve_lower(factor: &[f64], tree: &Tree, numbers: &mut [f64]) {
    for (number, node) in tree.nodes.iter().enumerate() {
        let panel = factor[tree.panel(number)].chunks_exact(node.width() + 1);
        for ((place, column), entries) in node.own.clone().enumerate().zip(panel) {
            numbers[column] /= entries[place];
            let known = numbers[column];
            for (row, entry) in (column + 1..node.own.end).zip(&entries[place + 1..]) {
                numbers[row] -= known * entry;
            }
            for (row, entry) in node.rest.iter().zip(&entries[node.own.len()..]) {
                numbers[*row] -= known * entry;
            }
        }
    }
}

/// Replaces numbers b, column by column, by L⁻ᵀ b, from all fronts of a factor L.
pub fn solve_upper(factor: &[f64], tree: &Tree, numbers: &mut [f64]) {
    for (number, node) in tree.nodes.iter().enumerate().rev() {
        let panel = &factor[tree.panel(number)];
        for (place, column) in node.own.clone().enumerate().rev() {
            let entries = &panel[place * (node.width() + 1)..][..node.width()];
            let nearer = numbers[column + 1..node.own.end].iter().zip(&entries[place + 1..]);
            let mut known = nearer.map(|(number, entry)| number * entry).sum::<f64>();
            let rest = node.rest.iter().zip(&entries[node.own.len()..]);
            known += rest.map(|(row, entry)| numbers[*row] * entry).sum::<f64>();
            numbers[column] = (numbers[column] - known) / entries[place];
        }
    }
}

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
