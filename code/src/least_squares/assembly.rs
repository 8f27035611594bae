//! The normal equations of a problem, written to where they are eliminated.

use std::array::from_fn;

use super::Linearized;
use super::elimination_tree::Tree;
use super::problem::{Columns, Problem};

// ANCHOR: assembly
/// Where the products of all factors' derivatives go, factor by factor in the order of the problem.
#[derive(Debug, Clone, Default)]
pub struct Assembly {
    segments: Vec<Placed>,
    /// By factor, where its segments end.
    ends: Vec<usize>,
    /// For each pair of a factor's segments, the earlier one first, where their product begins.
    products: Vec<usize>,
}

/// Coordinates of one of a factor's variables whose columns follow each other.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    pub slot: usize,
    /// The first coordinate.
    pub first: usize,
    pub len: usize,
    /// The first column, by its place in the order of elimination.
    pub column: usize,
}

#[derive(Debug, Clone, Copy)]
struct Placed {
    segment: Segment,
    /// From one of the columns to the next.
    stride: usize,
    /// Where the first one's right-hand side is.
    right_side: usize,
}
// ANCHOR_END: assembly

/// The segments of all factors, each factor's by their columns.
#[derive(Debug, Clone, Default)]
pub struct Segments {
    all: Vec<Segment>,
    /// By factor, where its segments end.
    ends: Vec<usize>,
}

/// So many segments few factors have more of.
const MANY: usize = 4;

impl Segments {
    pub fn of(problem: &Problem, columns: &Columns, place: &[usize]) -> Self {
        let of_variables = Self::of_variables(problem, columns, place);
        let factors = problem.len();
        let mut segments =
            Self { all: Vec::with_capacity(MANY * factors), ends: Vec::with_capacity(factors) };
        for (group, factor) in problem.factors() {
            let (begin, mut slot) = (segments.all.len(), 0);
            group.variables(factor, &mut |variable| {
                let own = of_variables.own(variable).iter();
                segments.all.extend(own.map(|segment| Segment { slot, ..*segment }));
                slot += 1;
            });
            segments.all[begin..].sort_by_key(|segment| segment.column);
            segments.ends.push(segments.all.len());
        }
        segments
    }

    /// Those of each variable, as if it was the only one of a factor.
    fn of_variables(problem: &Problem, columns: &Columns, place: &[usize]) -> Self {
        let Self { mut all, mut ends } = Self::default();
        for variable in 0..problem.values().len() {
            let begin = all.len();
            let coordinates = problem.values().coordinates_of(variable).unwrap_or_default();
            let columns = columns.of[coordinates].iter().enumerate();
            for (first, column) in columns.filter_map(|(at, c)| Some((at, place[(*c)?]))) {
                match all[begin..].last_mut() {
                    Some(last) if last.continues(first, column) => last.len += 1,
                    _ => all.push(Segment { slot: 0, first, len: 1, column }),
                }
            }
            ends.push(all.len());
        }
        Self { all, ends }
    }

    /// Those of one factor or variable.
    fn own(&self, number: usize) -> &[Segment] {
        let begin = if number == 0 { 0 } else { self.ends[number - 1] };
        &self.all[begin..self.ends[number]]
    }

    /// Those of one factor after the other.
    pub fn of_each(&self) -> impl Iterator<Item = &[Segment]> {
        (0..self.ends.len()).map(|factor| self.own(factor))
    }
}

impl Segment {
    fn continues(&self, coordinate: usize, column: usize) -> bool {
        (self.first + self.len, self.column + self.len) == (coordinate, column)
    }
}

impl Assembly {
    /// Finds the places from the segments of all factors, in the memory that is there.
    pub fn arrange(&mut self, of_factors: &Segments, tree: &Tree) {
        let Self { segments, ends, products } = self;
        segments.clear();
        ends.clear();
        products.clear();
        for own in of_factors.of_each() {
            for (at, &segment) in own.iter().enumerate() {
                let front = tree.front_of(segment.column);
                let (node, first) = (&tree.nodes[front], tree.start_of(segment.column, front));
                let (stride, right_side) = (node.width() + 1, first + node.width());
                segments.push(Placed { segment, stride, right_side });
                products.extend(own[at..].iter().map(|later| first + node.place(later.column)));
            }
            ends.push(segments.len());
        }
    }

    /// Adds what all factors say, once they are linearized.
    pub fn cursor(&self) -> Cursor<'_> {
        Cursor { assembly: self, factor: 0, segment: 0, product: 0 }
    }
}

/// How far an assembly has come.
pub struct Cursor<'a> {
    assembly: &'a Assembly,
    factor: usize,
    segment: usize,
    product: usize,
}

impl Cursor<'_> {
    // ANCHOR: add_products
    /// Adds what the next factors say: JᵀJ, and Jᵀr in the row of the right-hand side.
    #[inline(always)]
    pub fn add(&mut self, linear: &Linearized, into: &mut [f64]) {
        let rows = linear.rows();
        let residuals = linear.residuals().chunks_exact(rows);
        for (place, residual) in residuals.enumerate() {
            let end = self.assembly.ends[self.factor];
            let segments = &self.assembly.segments[self.segment..end];
            (self.factor, self.segment) = (self.factor + 1, end);
            let part = |Placed { segment: Segment { slot, first, len, .. }, .. }: &Placed| {
                let (width, filled) = (linear.columns(*slot), linear.filled(*slot));
                let slopes = &linear.jacobian(*slot)[place * rows * width..][..filled * width];
                (slopes, width, *first, *len)
            };
            for (at, left) in segments.iter().enumerate() {
                for right in &segments[at..] {
                    let product = &mut into[self.assembly.products[self.product]..];
                    self.product += 1;
                    add_product(product, left.stride, part(left), part(right));
                    if is_tied(&left.segment, &right.segment) {
                        add_product(product, left.stride, part(right), part(left));
                    }
                }
                add_product(
                    &mut into[left.right_side..],
                    left.stride,
                    part(left),
                    (residual, 1, 0, 1),
                );
            }
        }
    }
    // ANCHOR_END: add_products
}

/// Whether two variables of a factor take the same steps.
fn is_tied(left: &Segment, right: &Segment) -> bool {
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
        4 => add_product_of::<4>(into, stride, left, right),
        3 => add_product_of::<3>(into, stride, left, right),
        _ => {
            for column in 0..right.3 {
                let right = (right.0, right.1, right.2 + column, 1);
                add_product_of::<1>(&mut into[column..], stride, left, right);
            }
        }
    }
}

/// The same with `N` columns on the right, three rows at a time; with many rows all of them at once, for
/// three columns on the left.
#[inline(always)]
fn add_product_of<const N: usize>(into: &mut [f64], stride: usize, left: Part, right: Part) {
    let rows = (left.0.len() / left.1).min(right.0.len() / right.1);
    if rows > MANY_ROWS && left.3.is_multiple_of(3) {
        for column in (0..left.3).step_by(3) {
            let left = (left.0, left.1, left.2 + column, 3);
            add_tall::<3, N>(&mut into[column * stride..], stride, left, right);
        }
        return;
    }
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

/// With more rows than this, the sums are stored when all of them have been added.
const MANY_ROWS: usize = 6;

#[inline(always)]
fn add_tall<const C: usize, const N: usize>(
    into: &mut [f64],
    stride: usize,
    left: Part,
    right: Part,
) {
    let mut sums = [[0.0; N]; C];
    let rows = left.0.chunks_exact(left.1).zip(right.0.chunks_exact(right.1));
    for (left_row, right_row) in rows {
        let left: &[f64; C] = left_row[left.2..].first_chunk().expect("a row has C columns");
        let right: &[f64; N] = right_row[right.2..].first_chunk().expect("a row has N columns");
        for (sums, slope) in sums.iter_mut().zip(left) {
            for (sum, entry) in sums.iter_mut().zip(right) {
                *sum += slope * entry;
            }
        }
    }
    for (into, sums) in into.chunks_mut(stride).zip(sums) {
        into.iter_mut().zip(sums).for_each(|(into, sum)| *into += sum);
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
        let into = into.first_chunk_mut::<N>().expect("a column has N more rows");
        let mut sums = *into;
        for (slope, row) in slopes.iter().zip(right) {
            sums = from_fn(|at| sums[at] + slope * row[at]);
        }
        *into = sums;
    }
}
