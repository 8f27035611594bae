//! The normal equations, eliminated variable by variable in any order.

use std::iter::successors;
use std::ops::Range;

use nalgebra::DMatrix;

use super::assembly::{Assembly, Segment, Segments};
use super::covariance::Part;
use super::elimination_tree::{Node, Tree, elimination_tree};
use super::front::{
    Updates, covariance_of_front, factorize, solve_lower, solve_transposed, solve_upper,
};
use super::group::Point;
use super::ordering::{minimum_degree, neighbours};
use super::problem::{Columns, Problem};
use super::solver::{LinearSystem, Pivots, Prediction, SolveError};
use super::{Covariance, Linearized};
use crate::registers::wide;

// ANCHOR: fronts
/// The normal equations of a problem, eliminated front by front: the columns of some variables at a
/// time, with the rows of all later ones that they are coupled with by then ([@duff1983]). What a
/// front leaves is subtracted from the columns of later ones at once. Columns are numbered in the
/// order of elimination here.
#[derive(Debug, Clone, Default)]
pub struct Fronts {
    columns: Columns,
    /// The place of each of the problem's columns in the order.
    place: Vec<usize>,
    tree: Tree,
    assembly: Assembly,
    /// By front, what its elimination changes.
    updates: Updates,
    /// The lower triangle of the Hessian, and the gradient, front by front.
    hessian: Vec<f64>,
    /// Its Cholesky factor.
    factor: Vec<f64>,
    gradient: Vec<f64>,
    /// The diagonal of the Hessian.
    curvature: Vec<f64>,
    /// Pivots must be above this.
    smallest: Vec<f64>,
    /// Room for how all columns follow some that are moved.
    moved: Vec<f64>,
    /// The damping of the last elimination; infinite when a pivot was lost, and before there was one.
    damping: f64,
    /// Pivots of columns before this may have been lifted in it.
    lifted: usize,
    step: Vec<f64>,
    linear: Linearized,
}
// ANCHOR_END: fronts

impl Fronts {
    /// Room for the steps of a problem, in an order of elimination that fills in little:
    /// [`Fronts::order_by_degree`].
    ///
    /// # Errors
    ///
    /// [`SolveError::NoFactors`] and [`SolveError::NothingFree`].
    pub fn new(problem: &Problem) -> Result<Self, SolveError> {
        Self::in_order(problem, &Self::order_by_degree(problem))
    }

    // ANCHOR: in_order
    /// The same for variables, given by number, that are eliminated in this order. Those that it does
    /// not name come last, as they were added.
    ///
    /// # Errors
    ///
    /// [`SolveError::NoFactors`], [`SolveError::NothingFree`] and [`SolveError::NoSuchVariable`].
    pub fn in_order(problem: &Problem, order: &[usize]) -> Result<Self, SolveError> {
        let mut fronts = Self::default();
        fronts.arrange(problem, order)?;
        Ok(fronts)
    }

    /// Makes room for the steps of another problem, or of one that has changed, in the memory that these
    /// fronts have.
    ///
    /// # Errors
    ///
    /// As those of [`Fronts::in_order`].
    pub fn arrange(&mut self, problem: &Problem, order: &[usize]) -> Result<(), SolveError> {
        let columns = problem.columns_to_solve()?;
        let (blocks, place) = ordered_blocks(problem, &columns, order)?;
        let segments = Segments::of(problem, &columns, &place);
        let mut block_of = Vec::with_capacity(columns.count);
        blocks.iter().enumerate().for_each(|(number, block)| block_of.resize(block.end, number));
        let block_with = |segment: &Segment| block_of[segment.column];
        let couplings = segments.of_each().map(|of_factor| of_factor.iter().map(block_with));
        let tree = Tree::new(elimination_tree(&blocks, couplings));
        self.assembly.arrange(&segments, &tree);
        self.updates.arrange(&tree);
        for entries in [&mut self.hessian, &mut self.factor] {
            entries.resize(tree.len(), 0.0);
        }
        let Self { gradient, curvature, smallest, moved, step, .. } = self;
        for numbers in [gradient, curvature, smallest, moved, step] {
            numbers.resize(columns.count, 0.0);
        }
        self.damping = f64::INFINITY;
        (self.columns, self.place, self.tree) = (columns, place, tree);
        Ok(())
    }
    // ANCHOR_END: in_order

    // ANCHOR: by_degree
    /// An order that fills in little, whatever the problem: always a variable that is coupled with
    /// the fewest columns of others by then.
    pub fn order_by_degree(problem: &Problem) -> Vec<usize> {
        let columns = problem.columns();
        let block_of = |variable| {
            columns.block_of(problem.values().coordinates_of(variable).unwrap_or_default())
        };
        let block_of: Vec<Option<usize>> = (0..problem.values().len()).map(block_of).collect();
        let coupled = problem.factors().map(|(group, factor)| {
            let mut blocks = Vec::new();
            group.variables(factor, &mut |variable| blocks.extend(block_of[variable]));
            blocks
        });
        let sizes: Vec<usize> = columns.blocks.iter().map(ExactSizeIterator::len).collect();
        let neighbours = neighbours(sizes.len(), coupled);
        let mut variable = vec![0; sizes.len()];
        for (index, block) in block_of.iter().enumerate() {
            block.iter().for_each(|block| variable[*block] = index);
        }
        minimum_degree(neighbours, &sizes).into_iter().map(|block| variable[block]).collect()
    }
    // ANCHOR_END: by_degree

    // ANCHOR: along
    /// The order along a trunk of variables, as the states of a flight are: each in turn, and before
    /// it those of the others that share a factor with it and with none after it, as a landmark that
    /// is seen for the last time.
    ///
    /// # Errors
    ///
    /// [`SolveError::NoSuchVariable`].
    pub fn order_along(problem: &Problem, trunk: &[usize]) -> Result<Vec<usize>, SolveError> {
        let mut turn = vec![None; problem.values().len()];
        for (at, &variable) in trunk.iter().enumerate() {
            *turn.get_mut(variable).ok_or(SolveError::NoSuchVariable { variable })? = Some(at);
        }
        let mut last = turn.clone();
        for (group, factor) in problem.factors() {
            let mut latest = None;
            group.variables(factor, &mut |variable| latest = latest.max(turn[variable]));
            group.variables(factor, &mut |variable| {
                if turn[variable].is_none() {
                    last[variable] = last[variable].max(latest);
                }
            });
        }
        let mut order: Vec<usize> =
            (0..last.len()).filter(|variable| last[*variable].is_some()).collect();
        order.sort_by_key(|variable| (last[*variable], turn[*variable].is_some()));
        Ok(order)
    }
    // ANCHOR_END: along

    /// Eliminates all variables with the widest registers that the processor has. False when a pivot
    /// is lost in rounding, unless its column comes before `lifted`.
    fn eliminate_all(&mut self, damping: f64, lifted: usize) -> bool {
        let is_done = wide(
            #[inline(always)]
            || self.eliminate_each(damping, lifted),
        );
        self.damping = if is_done { damping } else { f64::INFINITY };
        self.lifted = lifted;
        is_done
    }

    #[inline(always)]
    // ANCHOR: front_by_front
    /// Eliminates front by front. False when a pivot is lost in rounding; before the column `lifted`
    /// such a pivot is as large as rounding errors.
    fn eliminate_each(&mut self, damping: f64, lifted: usize) -> bool {
        self.factor.copy_from_slice(&self.hessian);
        for (number, node) in self.tree.nodes.iter().enumerate() {
            let (order, panel) = (node.width() + 1, self.tree.panel(number));
            let (done, later) = self.factor.split_at_mut(panel.end);
            let done = &mut done[panel.start..];
            for (place, column) in node.own.clone().enumerate() {
                let curvature = self.curvature[column];
                done[place * (order + 1)] += Pivots::added(damping, curvature);
                self.smallest[column] = Pivots::smallest(damping, curvature);
            }
            let lifted = lifted.saturating_sub(node.own.start);
            if factorize(done, order, &self.smallest[node.own.clone()], lifted).is_err() {
                return false;
            }
            for update in self.updates.of(number) {
                let into = &mut later[self.tree.panel(update.front).start - panel.end..];
                update.apply((done, order), (into, self.tree.nodes[update.front].width() + 1));
            }
        }
        true
    }
    // ANCHOR_END: front_by_front

    // ANCHOR: back
    /// The step, from the last front back to the first. Returns twice the predicted decrease and
    /// the squared scaled length of the step: {eq:predicted-decrease-in-parts}.
    fn substitute_back(&mut self, damping: f64) -> (f64, f64) {
        let (mut twice_predicted, mut square) = (0.0, 0.0);
        for (number, node) in self.tree.nodes.iter().enumerate().rev() {
            let factor = &self.factor[self.tree.panel(number)];
            twice_predicted += solve_transposed(factor, node, &mut self.step);
            for column in node.own.clone() {
                let (step, curvature) = (self.step[column].powi(2), self.curvature[column]);
                twice_predicted += Pivots::added(damping, curvature) * step;
                square += curvature * step;
            }
        }
        (twice_predicted, square)
    }
    // ANCHOR_END: back

    // ANCHOR: covariances
    /// The covariance of the columns of each front, from the last front back to the first: that of
    /// the rest is part of its parent's ([@takahashi1973]).
    fn covariances(&self) -> Vec<Part> {
        let nodes = &self.tree.nodes;
        let mut parts: Vec<Part> = Vec::with_capacity(nodes.len());
        for (number, node) in nodes.iter().enumerate().rev() {
            let factor = &self.factor[self.tree.panel(number)];
            let rest = node.parent.map_or_else(
                || DMatrix::zeros(0, 0),
                |parent| self.rest_of(node, parent, &parts[nodes.len() - 1 - parent].matrix),
            );
            let matrix = covariance_of_front(factor, node.own.len(), rest);
            parts.push(Part { columns: node.columns().collect(), matrix });
        }
        parts
    }
    // ANCHOR_END: covariances

    // ANCHOR: covariance_of
    /// The covariance of some variables of a problem, given by number, as of the last linearization:
    /// from the last front back to the first that names one of them. `None` when one does not exist,
    /// all are held, no front has all of them, something of them is not determined, or rounding has changed
    /// what is known by more than a tenth. After a damped step the
    /// equations are eliminated again without its damping, which would count as knowledge. What the
    /// others do not determine, as the depth of a landmark at infinity, takes nothing away.
    pub fn covariance_of(
        &mut self,
        problem: &Problem,
        variables: &[usize],
    ) -> Option<DMatrix<f64>> {
        let values = problem.values();
        let own = variables.iter().map(|index| values.coordinates_of(*index));
        let own: Vec<_> = own.collect::<Option<_>>()?;
        let columns = own.into_iter().flat_map(|own| self.columns.select(own));
        let columns: Vec<usize> = columns.map(|column| self.place[column]).collect();
        let front = self.tree.front_of(*columns.iter().min()?);
        let node = &self.tree.nodes[front];
        let is_here = |column: &usize| node.own.contains(column) || node.rest.contains(column);
        let places = columns.iter().map(|column| is_here(column).then(|| node.place(*column)));
        let places: Vec<usize> = places.collect::<Option<_>>()?;
        let first = *columns.iter().min()?;
        let is_damped = self.damping > 0.0 || first < self.lifted;
        if is_damped && !self.eliminate_all(0.0, first) {
            return None;
        }
        let covariance = self.covariance_at(front).select_rows(&places).select_columns(&places);
        self.is_sharp(&columns, &covariance).then_some(covariance)
    }

    /// The covariance of the columns of a front, from the last one back to it.
    fn covariance_at(&self, front: usize) -> DMatrix<f64> {
        let nodes = &self.tree.nodes;
        let path: Vec<usize> = successors(Some(front), |at| nodes[*at].parent).collect();
        path.iter().rev().fold(DMatrix::zeros(0, 0), |covariance, &at| {
            let node = &nodes[at];
            let of_parent = |parent| self.rest_of(node, parent, &covariance);
            let rest = node.parent.map_or_else(|| DMatrix::zeros(0, 0), of_parent);
            covariance_of_front(&self.factor[self.tree.panel(at)], node.own.len(), rest)
        })
    }
    // ANCHOR_END: covariance_of

    // ANCHOR: is_sharp
    /// Whether rounding changes no variance of these columns by more than a tenth. What it changes of H,
    /// of each curvature a part, it changes of uᵀ H⁻¹ u as of xᵀ H x, for x = H⁻¹ u. Here u has each of
    /// the columns, over its standard deviation, and the changes are taken for independent.
    fn is_sharp(&mut self, columns: &[usize], covariance: &DMatrix<f64>) -> bool {
        let Self { tree, factor, curvature, moved, .. } = self;
        moved.fill(0.0);
        for (column, variance) in columns.iter().zip(&covariance.diagonal()) {
            moved[*column] = variance.sqrt().recip();
        }
        solve_lower(factor, tree, moved);
        solve_upper(factor, tree, moved);
        let off =
            |(moved, curvature): (&f64, &f64)| (f64::EPSILON * curvature * moved * moved).powi(2);
        let off: f64 = moved.iter().zip(curvature.iter()).map(off).sum();
        off.sqrt() < Pivots::SHARP
    }
    // ANCHOR_END: is_sharp

    /// The covariance of what a front leaves, which is a part of its parent's.
    fn rest_of(&self, node: &Node, parent: usize, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let places: Vec<usize> = self.tree.nodes[parent].places(&node.rest).collect();
        matrix.select_rows(&places).select_columns(&places)
    }

    /// How many columns the widest front has.
    pub fn widest(&self) -> usize {
        self.tree.nodes.iter().map(Node::width).max().unwrap_or(0)
    }

    /// How many numbers the Cholesky factor has.
    pub fn stored(&self) -> usize {
        let of_node = |node: &Node| {
            let own = node.own.len();
            own * (own + 1) / 2 + own * node.rest.len()
        };
        self.tree.nodes.iter().map(of_node).sum()
    }

    /// Multiplications of one elimination, those that assemble the fronts not counted.
    pub fn products(&self) -> usize {
        let of_column = |width: usize| width * (width + 1) / 2;
        let of_node = |node: &Node| (node.rest.len()..node.width()).map(of_column).sum::<usize>();
        self.tree.nodes.iter().map(of_node).sum()
    }
}

impl LinearSystem for Fronts {
    fn linearize(&mut self, problem: &Problem, at: Point) -> Result<Option<f64>, SolveError> {
        let Self { assembly, hessian, linear, .. } = self;
        hessian.fill(0.0);
        self.damping = f64::INFINITY;
        let mut cursor = assembly.cursor();
        let cost = problem.each_group(at, linear, |_, linear| {
            wide(
                #[inline(always)]
                || cursor.add(linear, hessian),
            );
        })?;
        for (number, node) in self.tree.nodes.iter().enumerate() {
            let columns = hessian[self.tree.panel(number)].chunks_exact(node.width() + 1);
            for ((place, column), entries) in node.own.clone().enumerate().zip(columns) {
                (self.curvature[column], self.gradient[column]) =
                    (entries[place], entries[node.width()]);
            }
        }
        if self.gradient_norm().is_finite() { Ok(Some(cost)) } else { Err(SolveError::OutOfRange) }
    }

    fn step(&mut self, damping: f64, into: &mut [f64]) -> Option<Prediction> {
        if !self.eliminate_all(damping, 0) {
            return None;
        }
        let (twice, square) = self.substitute_back(damping);
        for (into, column) in into.iter_mut().zip(&self.columns.of) {
            *into = column.map_or(0.0, |column| self.step[self.place[column]]);
        }
        Some(Prediction {
            step_norm: square.sqrt(),
            predicted_decrease: 0.5 * twice,
            gradient_norm: self.gradient_norm(),
        })
    }

    fn is_suspicious(&self) -> bool {
        self.tree.nodes.iter().enumerate().any(|(number, node)| {
            let factor = &self.factor[self.tree.panel(number)];
            node.own.clone().enumerate().any(|(place, column)| {
                let diagonal = factor[place * (node.width() + 2)];
                Pivots::are_suspicious(self.smallest[column], diagonal.powi(2))
            })
        })
    }

    fn gradient_norm(&self) -> f64 {
        let pairs = self.gradient.iter().zip(&self.curvature);
        pairs.map(|(g, h)| Pivots::scaled_square(*g, *h)).sum::<f64>().sqrt()
    }

    fn covariance(&mut self, problem: &Problem, at: Point) -> Result<Covariance, SolveError> {
        let null_space = problem.null_space_at(at)?;
        self.linearize(problem, at)?;
        if null_space.nullity() > 0 || !self.eliminate_all(0.0, 0) {
            return Err(null_space.undetermined());
        }
        let values = problem.values();
        let columns = |index| {
            let columns = self.columns.select(values.coordinates_of(index).unwrap_or_default());
            columns.into_iter().map(|column| self.place[column]).collect()
        };
        let of_variable = (0..values.len()).map(columns).collect();
        Ok(Covariance::of_parts(self.covariances(), of_variable))
    }
}

/// The blocks of columns in an order of variables, as ranges of places, and the place of each
/// column.
fn ordered_blocks(
    problem: &Problem,
    columns: &Columns,
    order: &[usize],
) -> Result<(Vec<Range<usize>>, Vec<usize>), SolveError> {
    let mut sequence = Vec::with_capacity(columns.blocks.len());
    let mut is_named = vec![false; columns.blocks.len()];
    for &variable in order {
        let coordinates = problem.values().coordinates_of(variable);
        let coordinates = coordinates.ok_or(SolveError::NoSuchVariable { variable })?;
        sequence.extend(
            columns.block_of(coordinates).filter(|b| !std::mem::replace(&mut is_named[*b], true)),
        );
    }
    sequence.extend((0..columns.blocks.len()).filter(|block| !is_named[*block]));
    let (mut blocks, mut place) = (Vec::with_capacity(sequence.len()), vec![0; columns.count]);
    let mut start = 0;
    for block in sequence {
        let own = columns.blocks[block].clone();
        let end = start + own.len();
        blocks.push(start..end);
        own.zip(start..end).for_each(|(column, new)| place[column] = new);
        start = end;
    }
    Ok((blocks, place))
}
