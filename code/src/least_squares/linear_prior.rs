//! What some factors have said, kept when they and some of their variables are gone.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use nalgebra::{DMatrix, DVector};

use super::group::{FactorGroup, Point, Undefined};
use super::linearized::Linearized;
use super::problem::{Buffer, Problem, check_repeated};
use super::solver::SolveError;
use super::sparse_rows::SparseRows;
use super::square_root::{Turned, eliminate_fronts};
use super::{Columns, ProblemError, Values};

// ANCHOR: linear_prior
/// A factor in square-root form, W (x ⊟ a) + d: what linearized factors say of the variables x that
/// are left when others have been eliminated. The anchors a are where x was linearized: where it stood
/// then, or where its linearization point had been frozen before.
///
/// Where a linearization point is frozen at the anchor, its Jacobian is the root W; elsewhere it is W
/// times the derivative of [`local`](super::Manifold::local).
#[derive(Debug)]
pub struct LinearPrior {
    /// The variables, by number.
    variables: Vec<usize>,
    anchors: Values,
    /// Their dimensions.
    columns: Vec<usize>,
    /// By variable, behind how many rows there are only zeros: the root is often a triangle.
    filled: Vec<usize>,
    root: DMatrix<f64>,
    offset: DVector<f64>,
    /// For steps and derivatives. Factors may be asked from several threads.
    memory: Mutex<Vec<f64>>,
}
// ANCHOR_END: linear_prior

impl LinearPrior {
    /// Takes variables out of a problem: eliminates them, in this order, from all factors that name one
    /// of them, as these are linearized at `values`, and keeps what they say of their other variables.
    /// The result does not depend on the order; the time does: landmarks should come first. A variable
    /// that is held is known already: of its factors nothing is taken.
    ///
    /// The problem stays as it is. The one that goes on is made without these variables and factors,
    /// and with the prior, whose variables [`LinearPrior::renumbered`] calls by their new numbers.
    ///
    /// # Errors
    ///
    /// [`SolveError::NoSuchVariable`] when a variable does not exist, [`SolveError::WrongValues`], and what
    /// linearizing at `values` gives.
    // ANCHOR: marginalize
    pub fn marginalize(
        problem: &Problem,
        values: &Values,
        variables: &[usize],
    ) -> Result<Self, SolveError> {
        problem.check_values(values)?;
        let columns = problem.columns();
        let (place, sizes) = first(&columns, values, variables)?;
        let mut rows = SparseRows::default();
        let is_first = |column: &usize| place[*column] < columns.count;
        let goes = |variable| {
            let coordinates = values.coordinates_of(variable).unwrap_or_default();
            columns.of[coordinates].iter().flatten().any(is_first)
        };
        let goes: Vec<bool> = (0..values.len()).map(goes).collect();
        problem.at(values, |at| {
            problem.each_row_of(
                |variable| goes[variable],
                at,
                &columns,
                &mut Buffer::default(),
                |row| {
                    let named = row.entries.iter().filter(|(_, slope)| *slope != 0.0);
                    let named = named.map(|(column, slope)| (place[*column], *slope));
                    let residual = (2 * columns.count, row.residual);
                    rows.push(named.chain([residual]));
                },
            )
        })?;
        let all = rows.by_first_column((0..rows.len()).collect());
        let (_, left) = eliminate_fronts(&mut rows, all, &together(&sizes));
        let (named, rows) = rows.dense(&rows.by_first_column(left));
        // A last row, in which nothing but a residual stands, is a constant.
        let turned = Turned::of(rows, named.len().saturating_sub(1));
        let stays: Vec<usize> = named.iter().map(|place| place - columns.count).collect();
        Ok(problem.at(values, |at| Self::of_rows(problem, at, &columns, (&stays, turned))))
    }
    // ANCHOR_END: marginalize

    /// The prior of rows that name these columns of a problem, and behind them the residual.
    fn of_rows(
        problem: &Problem,
        at: Point,
        columns: &Columns,
        (named, Turned { rows, own, .. }): (&[usize], Turned<f64>),
    ) -> Self {
        let values = at.values;
        let coordinates = |variable| values.coordinates_of(variable).unwrap_or_default();
        let named = &named[..named.len().saturating_sub(1)];
        let place = |coordinate: usize| named.binary_search(&columns.of[coordinate]?).ok();
        let leaders = (0..values.len()).filter(|variable| problem.leads(*variable));
        let variables: Vec<usize> =
            leaders.filter(|variable| coordinates(*variable).any(|c| place(c).is_some())).collect();
        let whole = variables.iter().flat_map(|variable| coordinates(*variable));
        let whole: Vec<Option<usize>> = whole.map(place).collect();
        let root = DMatrix::from_fn(own, whole.len(), |row, at| {
            whole[at].map_or(0.0, |column| rows.at(row, column))
        });
        let mut offset = DVector::from_fn(own, |row, _| rows.at(row, named.len()));
        // The rows are slopes at the linearization point, and their residuals stand at the values.
        if let Some(frozen) = at.frozen {
            let moved = frozen.local(values);
            let moved = variables.iter().flat_map(|variable| &moved[coordinates(*variable)]);
            offset -= &root * DVector::from_iterator(root.ncols(), moved.copied());
        }
        let anchors = at.frozen.unwrap_or(values).select(&variables).unwrap_or_default();
        Self::new(variables, anchors, root, offset)
    }

    /// The prior W (x ⊟ a) + d of variables that stand at their anchors a in `anchors`: the root W has a
    /// column for each coordinate of each variable, in the order given, and the offset d a number
    /// for each row of W. Both are whitened.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`] when a variable is none of `anchors`,
    /// [`ProblemError::RepeatedVariable`], [`ProblemError::EmptyFactor`] when the root has no rows, and
    /// [`ProblemError::Root`] when root or offset have another shape or a number that is not finite.
    pub fn of_root(
        anchors: &Values,
        variables: &[usize],
        root: DMatrix<f64>,
        offset: DVector<f64>,
    ) -> Result<Self, ProblemError> {
        if let Some(&variable) = variables.iter().find(|variable| **variable >= anchors.len()) {
            return Err(ProblemError::NoSuchVariable { variable, variables: anchors.len() });
        }
        check_repeated(variables, 0)?;
        let anchors = anchors.select(variables).unwrap_or_default();
        let is_finite = root.iter().chain(&offset).all(|number| number.is_finite());
        let (rows, columns, numbers) = (root.nrows(), root.ncols(), offset.len());
        let dimension = anchors.dimension();
        if !is_finite || columns != dimension || rows != numbers {
            return Err(ProblemError::Root { rows, columns, numbers, dimension });
        }
        if rows == 0 {
            return Err(ProblemError::EmptyFactor { factor: 0 });
        }
        Ok(Self::new(variables.to_vec(), anchors, root, offset))
    }

    fn new(
        variables: Vec<usize>,
        anchors: Values,
        root: DMatrix<f64>,
        offset: DVector<f64>,
    ) -> Self {
        let dimension = |at| anchors.coordinates_of(at).unwrap_or_default().len();
        let columns: Vec<usize> = (0..variables.len()).map(dimension).collect();
        let filled = |at| {
            let part = root.columns_range(anchors.coordinates_of(at).unwrap_or_default());
            let is_zero = |row: &usize| part.row(*row).iter().all(|entry| *entry == 0.0);
            root.nrows() - (0..root.nrows()).rev().take_while(is_zero).count()
        };
        let filled = (0..variables.len()).map(filled).collect();
        let widest = columns.iter().max().map_or(0, |dimension| dimension * dimension);
        let memory = Mutex::new(vec![0.0; root.ncols() + root.nrows() + widest]);
        Self { variables, anchors, columns, filled, root, offset, memory }
    }

    /// The variables, by number, in the order of the columns.
    pub fn variables(&self) -> &[usize] {
        &self.variables
    }

    /// The root W, with a column for each coordinate of each variable.
    pub fn root(&self) -> &DMatrix<f64> {
        &self.root
    }

    /// What the residual is at the anchors.
    pub fn offset(&self) -> &DVector<f64> {
        &self.offset
    }

    fn named(&self) -> (Vec<usize>, Values) {
        (self.variables.clone(), self.anchors.clone())
    }

    /// The same prior in a problem that calls the variables by other numbers.
    pub fn renumbered(mut self, number: impl Fn(usize) -> usize) -> Self {
        self.variables.iter_mut().for_each(|variable| *variable = number(*variable));
        self
    }

    /// The first variable that is none of these values, or of another kind or dimension.
    fn misfit(&self, values: &Values) -> Option<usize> {
        let fits =
            |(own, variable): &(usize, &usize)| self.anchors.is_like(*own, (values, **variable));
        let misfit = self.variables.iter().enumerate().find(|pair| !fits(pair));
        misfit.map(|(_, variable)| *variable)
    }

    // ANCHOR: prior_residual
    /// Calls with the residual at values, and with memory for derivatives.
    fn with_residual<T>(&self, values: &Values, call: impl FnOnce(&[f64], &mut [f64]) -> T) -> T {
        let mut memory = self.memory.lock().unwrap_or_else(PoisonError::into_inner);
        let (step, rest) = memory.split_at_mut(self.root.ncols());
        let (residual, free) = rest.split_at_mut(self.root.nrows());
        for (own, variable) in self.variables.iter().enumerate() {
            let part = self.anchors.coordinates_of(own).unwrap_or_default();
            // Whether they fit has been asked when the prior was added.
            let _ = self.anchors.local_to(own, (values, *variable), &mut step[part]);
        }
        residual.copy_from_slice(self.offset.as_slice());
        for (column, step) in self.root.column_iter().zip(step) {
            residual.iter_mut().zip(column.iter()).for_each(|(sum, slope)| *sum += slope * *step);
        }
        call(residual, free)
    }
    // ANCHOR_END: prior_residual
}

/// From the first number that is not zero to the last.
fn nonzero(numbers: &[f64]) -> Range<usize> {
    let is_some = |number: &f64| *number != 0.0;
    let first = numbers.iter().position(is_some).unwrap_or(0);
    first..numbers.iter().rposition(is_some).map_or(first, |last| last + 1)
}

/// The sizes of blocks, or their sum where it is so small that one triangle after another for each of
/// them would take longer.
fn together(sizes: &[usize]) -> Vec<usize> {
    let all: usize = sizes.iter().sum();
    if all <= MOST_TOGETHER { vec![all] } else { sizes.to_vec() }
}

/// So many columns are eliminated together.
const MOST_TOGETHER: usize = 32;

/// Where each column of a problem stands when some variables go first, one after the other, and what
/// stays stands behind as many columns as there are; and how many columns each of them has that none
/// before it has.
fn first(
    columns: &Columns,
    values: &Values,
    variables: &[usize],
) -> Result<(Vec<usize>, Vec<usize>), SolveError> {
    let mut place: Vec<usize> = (columns.count..2 * columns.count).collect();
    let (mut sizes, mut next) = (Vec::with_capacity(variables.len()), 0);
    for &variable in variables {
        let coordinates = values.coordinates_of(variable);
        let before = next;
        for column in columns.select(coordinates.ok_or(SolveError::NoSuchVariable { variable })?) {
            if place[column] >= columns.count {
                place[column] = next;
                next += 1;
            }
        }
        sizes.push(next - before);
    }
    Ok((place, sizes))
}

impl FactorGroup for LinearPrior {
    fn count(&self) -> usize {
        1
    }

    fn rows(&self) -> usize {
        self.root.nrows()
    }

    fn columns(&self) -> &[usize] {
        &self.columns
    }

    fn variables(&self, _factor: usize, visit: &mut dyn FnMut(usize)) {
        self.variables.iter().for_each(|variable| visit(*variable));
    }

    /// A group of one factor is kept or goes as a whole.
    fn retain(&mut self, _keep: &dyn Fn(usize) -> bool) {}

    fn cost(&self, factors: &[u32], values: &Values) -> f64 {
        let square = |residual: &[f64]| 0.5 * residual.iter().map(|r| r * r).sum::<f64>();
        factors.iter().map(|_| self.with_residual(values, |residual, _| square(residual))).sum()
    }

    fn residuals(
        &self,
        factors: &[u32],
        values: &Values,
        into: &mut Vec<f64>,
    ) -> Result<(), Undefined> {
        factors.iter().for_each(|_| {
            self.with_residual(values, |residual, _| into.extend_from_slice(residual))
        });
        Ok(())
    }

    // ANCHOR: prior_linearize
    fn linearize(
        &self,
        factors: &[u32],
        at: Point,
        into: &mut Linearized,
    ) -> Result<(), Undefined> {
        into.begin(factors.len(), self.rows(), &self.columns);
        let point = at.frozen.unwrap_or(at.values);
        self.with_residual(at.values, |residual, free| {
            into.cost += 0.5 * residual.iter().map(|r| r * r).sum::<f64>();
            into.write_residual_slice(residual);
            for (slot, variable) in self.variables.iter().enumerate() {
                let part = self.anchors.coordinates_of(slot).unwrap_or_default();
                if part.is_empty() {
                    continue;
                }
                let by_step = &mut free[..part.len() * part.len()];
                let _ = self.anchors.local_jacobian_to(slot, (point, *variable), by_step);
                let filled = self.filled[slot];
                into.fill_rows(slot, filled);
                for (column, by_step) in by_step.chunks_exact(part.len()).enumerate() {
                    // At the anchor this is a column of the identity.
                    let used = nonzero(by_step);
                    let root =
                        self.root.columns_range(part.start + used.start..part.start + used.end);
                    let by_step = &by_step[used];
                    let slope =
                        |row| by_step.iter().enumerate().map(|(at, by)| root[(row, at)] * by).sum();
                    into.write_column(slot, column, (0..filled).map(slope));
                }
            }
        });
        Ok(())
    }
    // ANCHOR_END: prior_linearize
}

impl Problem {
    // ANCHOR: marginalize_here
    /// Takes variables out of this problem: lets it begin at `values`, holds them there, and puts a
    /// [`LinearPrior`] in the place of all factors that name one of them. Returns the variables that
    /// it names. Other factors keep their numbers.
    ///
    /// # Errors
    ///
    /// As those of [`LinearPrior::marginalize`]; the problem then stays as it was.
    pub fn marginalize(
        &mut self,
        values: &Values,
        variables: &[usize],
    ) -> Result<Vec<usize>, SolveError> {
        let prior = LinearPrior::marginalize(self, values, variables)?;
        let named = prior.variables().to_vec();
        self.set_values(values.clone())?;
        self.forget(variables);
        if !prior.root.is_empty() {
            self.append(Box::new(prior));
        }
        Ok(named)
    }
    // ANCHOR_END: marginalize_here

    /// Adds what has been kept of other factors, and gives its number.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`] when a variable does not exist or is of another kind,
    /// [`ProblemError::RepeatedVariable`] when [`LinearPrior::renumbered`] has made two of them one, and
    /// [`ProblemError::EmptyFactor`] when nothing was said.
    pub fn add_prior(&mut self, prior: LinearPrior) -> Result<usize, ProblemError> {
        check_repeated(&prior.variables, self.factors)?;
        if let Some(variable) = prior.misfit(self.values()) {
            return Err(ProblemError::NoSuchVariable { variable, variables: self.values().len() });
        }
        self.add_group(Box::new(prior))
    }

    // ANCHOR: freeze_priors
    /// Freezes the linearization point of every variable that a prior names at the prior's anchor, and
    /// gives those that were not frozen before. All factors that name such a variable, whenever they are
    /// added, then take their derivatives where the prior took its own: first-estimates Jacobians
    /// ([@huang2008], [@dongsi2011]).
    ///
    /// What is frozen stays where it is: of two priors with different anchors the first one counts.
    pub fn freeze_priors(&mut self) -> Vec<usize> {
        let mut frozen = Vec::new();
        for (variables, anchors) in self.priors().map(LinearPrior::named).collect::<Vec<_>>() {
            for (own, variable) in variables.into_iter().enumerate() {
                if self.freeze_first(variable, (&anchors, own)) {
                    frozen.push(variable);
                }
            }
        }
        frozen
    }
    // ANCHOR_END: freeze_priors
}
