//! The normal equations of a problem, written to where they are eliminated.

use std::array::from_fn;

use super::Linearized;
use super::elimination_tree::Tree;
use super::problem::{Columns, Problem};

// ANCHOR: assembly
/// Where the products of all factors' derivatives go, factor by factor in the order of the problem.
#[derive(Debug, Clone)]
pub struct Assembly {
    runs: Vec<Run>,
    /// By factor, where its runs end.
    ends: Vec<usize>,
    /// For each pair of a factor's runs, the earlier column's first, where their product begins.
    products: Vec<usize>,
}

/// Coordinates of one of a factor's variables whose columns follow each other.
#[derive(Debug, Clone, Copy)]
struct Run {
    slot: usize,
    first: usize,
    len: usize,
    /// The first of the columns, by their order of elimination.
    column: usize,
    /// From one of the columns to the next.
    stride: usize,
    /// Where the first one's right-hand side is.
    right_side: usize,
}
// ANCHOR_END: assembly

/// The runs of coordinates of all factors, factor by factor.
pub fn runs_of(problem: &Problem, columns: &Columns, place: &[usize]) -> Vec<Vec<[usize; 4]>> {
    let mut all = Vec::with_capacity(problem.len());
    for group in (0..problem.group_count()).map(|group| problem.group(group)) {
        for factor in 0..group.count() {
            let (mut runs, mut slot): (Vec<[usize; 4]>, usize) = (Vec::new(), 0);
            group.variables(factor, &mut |variable| {
                let coordinates = problem.values().coordinates_of(variable).unwrap_or_default();
                for (at, column) in columns.of[coordinates].iter().enumerate() {
                    let Some(column) = column.map(|column| place[column]) else { continue };
                    match runs.last_mut() {
                        Some([last, first, len, start])
                            if *last == slot && *first + *len == at && *start + *len == column =>
                        {
                            *len += 1;
                        }
                        _ => runs.push([slot, at, 1, column]),
                    }
                }
                slot += 1;
            });
            runs.sort_by_key(|[.., column]| *column);
            all.push(runs);
        }
    }
    all
}

impl Assembly {
    /// From the runs of all factors.
    pub fn new(runs_of_factors: &[Vec<[usize; 4]>], tree: &Tree) -> Self {
        let (mut runs, mut ends, mut products) = (Vec::new(), Vec::new(), Vec::new());
        for own in runs_of_factors {
            for (at, &[slot, first, len, column]) in own.iter().enumerate() {
                let stride = tree.nodes[tree.front_of(column)].width() + 1;
                let right_side = tree.entry(column, None);
                runs.push(Run { slot, first, len, column, stride, right_side });
                products.extend(own[at..].iter().map(|later| tree.entry(column, Some(later[3]))));
            }
            ends.push(runs.len());
        }
        Self { runs, ends, products }
    }

    /// Adds what all factors say, once they are linearized.
    pub fn cursor(&self) -> Cursor<'_> {
        Cursor { assembly: self, factor: 0, run: 0, product: 0 }
    }
}

/// How far an assembly has come.
pub struct Cursor<'a> {
    assembly: &'a Assembly,
    factor: usize,
    run: usize,
    product: usize,
}

impl Cursor<'_> {
    // ANCHOR: add_products
    /// Adds what the next factors say: JᵀJ, and Jᵀr in the row of the right-hand side.
    #[inline(always)]
    pub fn add(&mut self, linear: &Linearized, into: &mut [f64]) {
        let rows = linear.rows();
        for residual in linear.residuals().chunks_exact(rows).take(linear.len()).enumerate() {
            let (place, residual) = residual;
            let end = self.assembly.ends[self.factor];
            let runs = &self.assembly.runs[self.run..end];
            (self.factor, self.run) = (self.factor + 1, end);
            let part = |run: &Run| {
                let width = linear.columns(run.slot);
                let whole =
                    &linear.jacobian(run.slot)[place * rows * width..(place + 1) * rows * width];
                (whole, width, run.first, run.len)
            };
            for (at, left) in runs.iter().enumerate() {
                for right in &runs[at..] {
                    let product = &mut into[self.assembly.products[self.product]..];
                    self.product += 1;
                    add_product(product, left.stride, part(left), part(right));
                    if at_same_columns(left, right) {
                        add_product(product, left.stride, part(right), part(left));
                    }
                }
                let (slopes, width, first, len) = part(left);
                for (slopes, residual) in slopes.chunks_exact(width).zip(residual) {
                    for (column, slope) in slopes[first..first + len].iter().enumerate() {
                        into[left.right_side + column * left.stride] += slope * residual;
                    }
                }
            }
        }
    }
    // ANCHOR_END: add_products
}

/// Whether two variables of a factor are tied to one.
fn at_same_columns(left: &Run, right: &Run) -> bool {
    left.slot != right.slot && left.column == right.column
}

/// Columns of a matrix of derivatives: its rows, their length, the first of the columns and how many
/// there are.
type Part<'a> = (&'a [f64], usize, usize, usize);

/// Adds the products of the columns of two matrices.
#[inline(always)]
fn add_product(into: &mut [f64], stride: usize, left: Part, right: Part) {
    match right.3 {
        9 => add_product_of::<9>(into, stride, left, right),
        6 => add_product_of::<6>(into, stride, left, right),
        3 => add_product_of::<3>(into, stride, left, right),
        _ => (0..right.3).for_each(|column| {
            let right = (right.0, right.1, right.2 + column, 1);
            add_product_of::<1>(&mut into[column..], stride, left, right);
        }),
    }
}

/// The same with `N` columns on the right, three rows at a time.
#[inline(always)]
fn add_product_of<const N: usize>(into: &mut [f64], stride: usize, left: Part, right: Part) {
    let rows = left.0.len() / left.1;
    for row in (0..rows).step_by(3) {
        let (left, right) = (
            (&left.0[row * left.1..], left.1, left.2, left.3),
            (&right.0[row * right.1..], right.1, right.2, N),
        );
        match rows - row {
            1 => add_rows::<1, N>(into, stride, left, right),
            2 => add_rows::<2, N>(into, stride, left, right),
            _ => add_rows::<3, N>(into, stride, left, right),
        }
    }
}

#[inline(always)]
fn add_rows<const R: usize, const N: usize>(
    into: &mut [f64],
    stride: usize,
    (left, left_width, left_first, columns): Part,
    (right, width, first, _): Part,
) {
    let left: [&[f64]; R] = from_fn(|row| &left[row * left_width + left_first..][..columns]);
    let right: [&[f64; N]; R] = from_fn(|row| {
        right[row * width + first..].first_chunk().expect("a row has N more columns")
    });
    for (column, into) in into.chunks_mut(stride).take(columns).enumerate() {
        let slopes = left.map(|row| row[column]);
        for (at, sum) in into.iter_mut().take(N).enumerate() {
            for (slope, row) in slopes.iter().zip(right) {
                *sum += slope * row[at];
            }
        }
    }
}
