//! The normal equations, eliminated variable by variable in any order.

use std::mem::take;
use std::ops::Range;

use nalgebra::DMatrix;

use super::Covariance;
use super::covariance::Part;
use super::elimination_tree::{Node, elimination_tree};
use super::front::{add_rest, covariance_of_front, eliminate, solve_transposed};
use super::group::Point;
use super::problem::{Buffer, Columns, Problem};
use super::solver::{LinearSystem, Pivots, Prediction, SolveError};
use crate::registers::wide;

// ANCHOR: fronts
/// The normal equations of a problem, eliminated front by front: a dense matrix takes the rows that
/// name the next variables and what earlier fronts have left of these, eliminates them, and hands on
/// the rest ([@duff1983]). Columns are numbered in the order of elimination here.
#[derive(Debug, Clone)]
pub struct Fronts {
    columns: Columns,
    /// The place of each of the problem's columns in the order.
    place: Vec<usize>,
    nodes: Vec<Node>,
    /// By front.
    memory: Vec<Memory>,
    /// The rows of the Jacobian, in the order of the problem.
    chunks: Vec<Chunk>,
    /// By front, its chunks.
    chunks_of: Vec<Vec<usize>>,
    /// Derivatives and residuals, row by row.
    entries: Vec<f64>,
    /// Fronts at work. A front has one from its first child on until it is eliminated.
    boards: Vec<Vec<f64>>,
    /// The columns of the Cholesky factor, front by front.
    factor: Vec<f64>,
    gradient: Vec<f64>,
    /// The diagonal of the Hessian.
    curvature: Vec<f64>,
    /// Pivots must be above this.
    smallest: Vec<f64>,
    step: Vec<f64>,
    buffer: Buffer,
}
// ANCHOR_END: fronts

/// Where a front works, and where it leaves what.
#[derive(Debug, Clone, Default)]
struct Memory {
    board: usize,
    /// Whether fronts before it have left something on the board.
    has_children: bool,
    /// Whether it is the first to leave something on its parent's board.
    begins_parent: bool,
    /// Its part of the factor.
    factor: Range<usize>,
    /// The places in its parent of what it leaves, and of the right-hand side.
    in_parent: Vec<usize>,
}

/// Rows of the Jacobian that name the same columns.
#[derive(Debug, Clone)]
struct Chunk {
    rows: usize,
    /// For each entry, in the order in which the problem gives them, its place in a stored row.
    sorted: Vec<usize>,
    /// Places in the front, ascending, the last of them that of the right-hand side. None when the
    /// rows name nothing that moves.
    places: Vec<usize>,
    /// Where the rows begin.
    start: usize,
}

impl Fronts {
    // ANCHOR: new
    /// Room for the steps of a problem whose variables, given by number, are eliminated in this
    /// order. Those that it does not name come last, as they were added.
    ///
    /// # Errors
    ///
    /// [`SolveError::NoFactors`], [`SolveError::NothingFree`], [`SolveError::NoSuchVariable`], and
    /// what linearizing at the problem's values gives.
    pub fn new(problem: &Problem, order: &[usize]) -> Result<Self, SolveError> {
        let columns = problem.columns_to_solve()?;
        let (blocks, place) = ordered_blocks(problem, &columns, order)?;
        let mut rows: Vec<Vec<usize>> = Vec::with_capacity(problem.rows());
        problem.at(problem.values(), |at| {
            problem.each_row(at, &columns, &mut Buffer::default(), |row| {
                rows.push(row.entries.iter().map(|(column, _)| place[*column]).collect());
            })
        })?;
        let nodes = elimination_tree(&blocks, rows.iter().map(Vec::as_slice));
        let zeros = vec![0.0; columns.count];
        let mut fronts = Self {
            place,
            memory: vec![Memory::default(); nodes.len()],
            chunks: Vec::new(),
            chunks_of: vec![Vec::new(); nodes.len()],
            entries: Vec::new(),
            boards: Vec::new(),
            factor: Vec::new(),
            gradient: zeros.clone(),
            curvature: zeros.clone(),
            smallest: zeros.clone(),
            step: zeros,
            buffer: Buffer::default(),
            nodes,
            columns,
        };
        fronts.take_memory();
        rows.chunk_by(|one, next| one == next).for_each(|rows| fronts.add_chunk(rows));
        Ok(fronts)
    }
    // ANCHOR_END: new

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
        for group in (0..problem.group_count()).map(|group| problem.group(group)) {
            for factor in 0..group.count() {
                let mut latest = None;
                group.variables(factor, &mut |variable| latest = latest.max(turn[variable]));
                group.variables(factor, &mut |variable| {
                    if turn[variable].is_none() {
                        last[variable] = last[variable].max(latest);
                    }
                });
            }
        }
        let mut order: Vec<usize> =
            (0..last.len()).filter(|variable| last[*variable].is_some()).collect();
        order.sort_by_key(|variable| (last[*variable], turn[*variable].is_some()));
        Ok(order)
    }
    // ANCHOR_END: along

    /// Gives each front a board and a part of the factor.
    fn take_memory(&mut self) {
        let (mut free, mut sizes): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut board_of: Vec<Option<usize>> = vec![None; self.nodes.len()];
        let mut kept = 0;
        for (number, node) in self.nodes.iter().enumerate() {
            for front in [Some(number), node.parent].into_iter().flatten() {
                let order = self.nodes[front].width() + 1;
                let board = *board_of[front].get_or_insert_with(|| {
                    free.pop().unwrap_or_else(|| {
                        sizes.push(0);
                        sizes.len() - 1
                    })
                });
                sizes[board] = sizes[board].max(order * order);
                self.memory[front].board = board;
            }
            let len = (node.width() + 1) * node.own.len();
            self.memory[number].factor = kept..kept + len;
            kept += len;
            if let Some(parent) = node.parent {
                let into = &self.nodes[parent];
                let places = node.rest.iter().map(|column| into.place(*column));
                self.memory[number].in_parent = places.chain([into.width()]).collect();
                self.memory[number].begins_parent = !self.memory[parent].has_children;
                self.memory[parent].has_children = true;
            }
            free.push(self.memory[number].board);
        }
        self.boards = sizes.into_iter().map(|size| vec![0.0; size]).collect();
        self.factor = vec![0.0; kept];
    }

    /// Adds rows of the Jacobian that name the same columns.
    fn add_chunk(&mut self, rows: &[Vec<usize>]) {
        let columns = &rows[0];
        let mut by_column: Vec<usize> = (0..columns.len()).collect();
        by_column.sort_by_key(|entry| columns[*entry]);
        let mut sorted = vec![0; columns.len()];
        by_column.iter().zip(0..).for_each(|(entry, place)| sorted[*entry] = place);
        let mut places = Vec::new();
        if let Some(first) = columns.iter().min() {
            let front = self.nodes.partition_point(|node| node.own.end <= *first);
            let node = &self.nodes[front];
            places = by_column.iter().map(|entry| node.place(columns[*entry])).collect();
            places.push(node.width());
            self.chunks_of[front].push(self.chunks.len());
        }
        let start = self.entries.len();
        self.entries.resize(start + rows.len() * places.len(), 0.0);
        self.chunks.push(Chunk { rows: rows.len(), sorted, places, start });
    }

    /// Eliminates all variables with the widest registers that the processor has. False when a pivot
    /// is lost in rounding.
    fn eliminate_all(&mut self, damping: f64) -> bool {
        wide(
            #[inline(always)]
            || self.eliminate_each(damping),
        )
    }

    #[inline(always)]
    // ANCHOR: front_by_front
    /// Eliminates front by front. False when a pivot is lost in rounding.
    fn eliminate_each(&mut self, damping: f64) -> bool {
        for (number, node) in self.nodes.iter().enumerate() {
            let (memory, order) = (&self.memory[number], node.width() + 1);
            let mut board = take(&mut self.boards[memory.board]);
            let front = &mut board[..order * order];
            if !memory.has_children {
                front.fill(0.0);
            }
            for chunk in &self.chunks_of[number] {
                self.chunks[*chunk].add_to(front, order, &self.entries);
            }
            let pivots = &mut self.smallest[node.own.clone()];
            for (place, smallest) in pivots.iter_mut().enumerate() {
                let curvature = self.curvature[node.own.start + place];
                front[place * (order + 1)] += Pivots::added(damping, curvature);
                *smallest = Pivots::smallest(damping, curvature);
            }
            let is_regular = eliminate(front, order, node.own.len(), pivots).is_ok();
            self.factor[memory.factor.clone()].copy_from_slice(&front[..memory.factor.len()]);
            if let Some(parent) = node.parent {
                let into = &mut self.boards[self.memory[parent].board];
                let into = (into.as_mut_slice(), self.nodes[parent].width() + 1);
                add_rest(front, order, &memory.in_parent, into, memory.begins_parent);
            }
            self.boards[memory.board] = board;
            if !is_regular {
                return false;
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
        for (node, memory) in self.nodes.iter().zip(&self.memory).rev() {
            let factor = &self.factor[memory.factor.clone()];
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
        let last = self.nodes.len() - 1;
        let mut parts: Vec<Part> = Vec::with_capacity(self.nodes.len());
        for (node, memory) in self.nodes.iter().zip(&self.memory).rev() {
            let factor = &self.factor[memory.factor.clone()];
            let rest = node.parent.map_or_else(
                || DMatrix::zeros(0, 0),
                |parent| {
                    let places = &memory.in_parent[..node.rest.len()];
                    parts[last - parent].matrix.select_rows(places).select_columns(places)
                },
            );
            let matrix = covariance_of_front(factor, node.own.len(), rest);
            parts.push(Part { columns: node.columns().collect(), matrix });
        }
        parts
    }
    // ANCHOR_END: covariances

    /// Whether a pivot is so small that the Jacobian has to decide.
    fn is_suspicious(&self) -> bool {
        self.nodes.iter().zip(&self.memory).any(|(node, memory)| {
            let factor = &self.factor[memory.factor.clone()];
            node.own.clone().enumerate().any(|(place, column)| {
                let diagonal = factor[place * (node.width() + 2)];
                Pivots::are_suspicious(self.smallest[column], diagonal.powi(2))
            })
        })
    }

    /// How many columns the widest front has.
    pub fn widest(&self) -> usize {
        self.nodes.iter().map(Node::width).max().unwrap_or(0)
    }

    /// How many numbers the Cholesky factor has.
    pub fn stored(&self) -> usize {
        let of_node = |node: &Node| {
            let own = node.own.len();
            own * (own + 1) / 2 + own * node.rest.len()
        };
        self.nodes.iter().map(of_node).sum()
    }

    /// Multiplications of one elimination, those that assemble the fronts not counted.
    pub fn products(&self) -> usize {
        let of_column = |width: usize| width * (width + 1) / 2;
        let of_node = |node: &Node| (node.rest.len()..node.width()).map(of_column).sum::<usize>();
        self.nodes.iter().map(of_node).sum()
    }
}

impl Chunk {
    /// Adds the products of the rows' entries to the lower triangle of a front.
    #[inline(always)]
    fn add_to(&self, front: &mut [f64], order: usize, entries: &[f64]) {
        let width = self.places.len();
        for row in entries[self.start..self.start + self.rows * width].chunks_exact(width) {
            for (at, place) in self.places.iter().enumerate() {
                let column = &mut front[place * order..(place + 1) * order];
                for (below, slope) in self.places[at..].iter().zip(&row[at..]) {
                    column[*below] += row[at] * slope;
                }
            }
        }
    }
}

impl LinearSystem for Fronts {
    fn linearize(&mut self, problem: &Problem, at: Point) -> Result<(), SolveError> {
        let Self { columns, place, chunks, entries, gradient, curvature, buffer, .. } = self;
        gradient.fill(0.0);
        curvature.fill(0.0);
        let mut rows = chunks.iter().flat_map(|chunk| (0..chunk.rows).map(move |row| (chunk, row)));
        problem.each_row(at, columns, buffer, |row| {
            let Some((chunk, number)) = rows.next() else { return };
            let Some(last) = chunk.places.len().checked_sub(1) else { return };
            let stored = &mut entries[chunk.start + number * (last + 1)..][..last + 1];
            stored[last] = row.residual;
            for ((column, slope), sorted) in row.entries.iter().zip(&chunk.sorted) {
                stored[*sorted] = *slope;
                gradient[place[*column]] += slope * row.residual;
                curvature[place[*column]] += slope * slope;
            }
        })?;
        if self.gradient_norm().is_finite() { Ok(()) } else { Err(SolveError::OutOfRange) }
    }

    fn step(
        &mut self,
        problem: &Problem,
        at: Point,
        damping: f64,
        into: &mut [f64],
    ) -> Option<Prediction> {
        if !self.eliminate_all(damping) {
            return None;
        }
        if damping == 0.0 && self.is_suspicious() && !problem.is_determined(at) {
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

    fn gradient_norm(&self) -> f64 {
        let pairs = self.gradient.iter().zip(&self.curvature);
        pairs.map(|(g, h)| Pivots::scaled_square(*g, *h)).sum::<f64>().sqrt()
    }

    fn covariance(&mut self, problem: &Problem, at: Point) -> Result<Covariance, SolveError> {
        let null_space = problem.null_space_at(at)?;
        self.linearize(problem, at)?;
        if null_space.nullity() > 0 || !self.eliminate_all(0.0) {
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
