//! A symmetric matrix of blocks, factored front by front.

use nalgebra::SMatrix;

use super::elimination_tree::{Tree, elimination_tree};
use super::front::{Updates, factorize, solve_lower, solve_upper};
use super::ordering::{minimum_degree, neighbours};
use crate::registers::wide;

// ANCHOR: sparse_cholesky
/// A sparse symmetric matrix of blocks and its Cholesky factor, by the same elimination as that of
/// [`Fronts`](super::Fronts), for matrices that no Jacobian comes with: those of linear problems with
/// several right-hand sides, and those of which it is asked whether they are positive definite at all.
#[derive(Debug, Clone)]
pub struct SparseCholesky {
    sizes: Vec<usize>,
    /// By block, the place of its first column in the order of elimination.
    starts: Vec<usize>,
    tree: Tree,
    updates: Updates,
    /// The lower triangle, front by front.
    matrix: Vec<f64>,
    factor: Vec<f64>,
}
// ANCHOR_END: sparse_cholesky

impl SparseCholesky {
    /// A matrix of zeros with blocks of these sizes, in which the named pairs of blocks, and each block
    /// with itself, may become others.
    pub fn new(sizes: &[usize], pairs: &[[usize; 2]]) -> Self {
        let neighbours = neighbours(sizes.len(), pairs.iter().map(|pair| pair.to_vec()));
        let order = minimum_degree(neighbours, sizes);
        let (mut starts, mut blocks) = (vec![0; sizes.len()], Vec::with_capacity(sizes.len()));
        let mut place = vec![0; sizes.len()];
        let mut end = 0;
        for block in order {
            (starts[block], place[block]) = (end, blocks.len());
            end += sizes[block];
            blocks.push(starts[block]..end);
        }
        let couplings = pairs.iter().map(|pair| pair.map(|block| place[block]).into_iter());
        let tree = Tree::new(elimination_tree(&blocks, couplings));
        let mut updates = Updates::default();
        updates.arrange(&tree);
        let (matrix, factor) = (vec![0.0; tree.len()], vec![0.0; tree.len()]);
        Self { sizes: sizes.to_vec(), starts, tree, updates, matrix, factor }
    }

    /// How many columns there are.
    pub fn dimension(&self) -> usize {
        self.sizes.iter().sum()
    }

    // ANCHOR: add_block
    /// Adds to the block in these rows and columns, and to its mirror image. Rows and columns that the
    /// blocks do not have are left out, and so is what stands above the diagonal of a block in its own
    /// rows. The pair has to be one that [`SparseCholesky::new`] was told.
    pub fn add<const R: usize, const C: usize>(
        &mut self,
        rows: usize,
        columns: usize,
        block: &SMatrix<f64, R, C>,
    ) {
        if self.starts[rows] < self.starts[columns] {
            return self.add(columns, rows, &block.transpose());
        }
        let (row, column) = (self.starts[rows], self.starts[columns]);
        let stride = self.tree.nodes[self.tree.front_of(column)].width() + 1;
        // Columns of a block are of one front, and so are its rows: they follow each other there.
        let first = self.tree.entry(column, row);
        for own in 0..self.sizes[columns].min(C) {
            let from = if rows == columns { own } else { 0 };
            for other in from..self.sizes[rows].min(R) {
                self.matrix[first + own * stride + other] += block[(other, own)];
            }
        }
    }
    // ANCHOR_END: add_block

    // ANCHOR: factorize_shifted
    /// Factors the matrix with this added to its diagonal, by block and coordinate. False when the sum
    /// is not positive definite, to rounding.
    pub fn factorize(&mut self, shift: impl Fn(usize, usize) -> f64) -> bool {
        self.factor.copy_from_slice(&self.matrix);
        for (block, (start, size)) in self.starts.iter().zip(&self.sizes).enumerate() {
            for coordinate in 0..*size {
                let column = start + coordinate;
                self.factor[self.tree.entry(column, column)] += shift(block, coordinate);
            }
        }
        wide(
            #[inline(always)]
            || self.eliminate(),
        )
    }

    #[inline(always)]
    fn eliminate(&mut self) -> bool {
        let zeros = vec![0.0; self.tree.nodes.iter().map(|node| node.own.len()).max().unwrap_or(0)];
        for (number, node) in self.tree.nodes.iter().enumerate() {
            let (order, panel) = (node.width() + 1, self.tree.panel(number));
            let (done, later) = self.factor.split_at_mut(panel.end);
            let done = &mut done[panel.start..];
            if factorize(done, order, &zeros[..node.own.len()], 0).is_err() {
                return false;
            }
            for update in self.updates.of(number) {
                let into = &mut later[self.tree.panel(update.front).start - panel.end..];
                update.apply((done, order), (into, self.tree.nodes[update.front].width() + 1));
            }
        }
        true
    }
    // ANCHOR_END: factorize_shifted

    // ANCHOR: solve_blocks
    /// Replaces a right-hand side, block after block, by the solution with the matrix that was factored
    /// last.
    pub fn solve(&self, vector: &mut [f64]) {
        let columns = || self.starts.iter().zip(&self.sizes).flat_map(|(at, size)| *at..at + size);
        let mut by_place = vec![0.0; vector.len()];
        columns().zip(vector.iter()).for_each(|(place, number)| by_place[place] = *number);
        solve_lower(&self.factor, &self.tree, &mut by_place);
        solve_upper(&self.factor, &self.tree, &mut by_place);
        columns().zip(vector).for_each(|(place, number)| *number = by_place[place]);
    }
    // ANCHOR_END: solve_blocks
}
