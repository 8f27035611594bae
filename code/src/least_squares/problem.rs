//! Variables and the factors between them.

use std::any::Any;
use std::ops::Range;

use nalgebra::DVector;
use thiserror::Error;

use super::group::{FactorGroup, FactorSet, Point, Undefined};
use super::kernel::{Kernel, KernelError};
use super::linearized::Linearized;
use super::solver::SolveError;
use super::{Factor, Jacobians, Key, LinearPrior, Manifold, Values, Variables};

// ANCHOR: problem
/// A least-squares problem: variables of any kinds, some of them held, and factors.
///
/// Solving it does not change it: it keeps the values that it was given, and a solution has its
/// own.
#[derive(Default)]
pub struct Problem {
    values: Values,
    /// By coordinate, whether it stays where it is.
    held: Vec<bool>,
    /// By variable, the one whose steps it takes: itself, unless it is tied to another.
    leader: Vec<usize>,
    /// By variable, whether its linearization point is frozen, and where.
    frozen: Vec<bool>,
    anchors: Values,
    groups: Vec<Group>,
    /// The number of the next factor.
    pub(super) factors: usize,
}
// ANCHOR_END: problem

/// Factors of one type with one kernel.
struct Group {
    factors: Box<dyn FactorGroup>,
    /// The number of each in the problem.
    numbers: Vec<usize>,
    /// The places of all of them, in order.
    all: Vec<u32>,
}

impl Group {
    /// Keeps the factors of which every variable passes.
    fn retain(&mut self, passes: impl Fn(usize) -> bool) {
        let keep = |place: usize| {
            let mut keeps = true;
            self.factors.variables(place, &mut |variable| keeps &= passes(variable));
            keeps
        };
        let kept: Vec<bool> = (0..self.factors.count()).map(keep).collect();
        self.factors.retain(&|place| kept[place]);
        let mut kept = kept.into_iter();
        self.numbers.retain(|_| kept.next().unwrap_or(false));
        self.all.truncate(self.numbers.len());
    }
}

impl Problem {
    /// A problem without variables and factors.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a variable that begins at `value`.
    pub fn add_variable<V: Manifold>(&mut self, value: V) -> Key<V> {
        self.anchors.add(value.clone());
        let key = self.values.add(value);
        self.held.resize(self.values.dimension(), false);
        self.leader.push(key.index());
        self.frozen.push(false);
        key
    }

    /// Keeps a variable where it is.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`].
    pub fn hold<V: Manifold>(&mut self, variable: Key<V>) -> Result<(), ProblemError> {
        let coordinates = self.coordinates(variable)?;
        self.held[coordinates].fill(true);
        Ok(())
    }

    /// Keeps some coordinates of a variable's step at zero, as the velocity of a state of which
    /// only pictures tell.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`] and [`ProblemError::NoSuchCoordinate`].
    pub fn hold_coordinates<V: Manifold>(
        &mut self,
        variable: Key<V>,
        which: Range<usize>,
    ) -> Result<(), ProblemError> {
        let coordinates = self.coordinates(variable)?;
        let dimension = coordinates.len();
        if which.end > dimension {
            let coordinate = which.end - 1;
            return Err(ProblemError::NoSuchCoordinate { coordinate, dimension });
        }
        let held = &mut self.held[coordinates];
        held.iter_mut().take(which.end).skip(which.start).for_each(|held| *held = true);
        Ok(())
    }

    /// Lets a variable take every step that another one takes, as two cameras on one rig do.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`], and [`ProblemError::Tied`] when the dimensions differ.
    pub fn tie<V: Manifold>(&mut self, variable: Key<V>, to: Key<V>) -> Result<(), ProblemError> {
        let (own, other) = (self.coordinates(variable)?.len(), self.coordinates(to)?.len());
        if own != other {
            return Err(ProblemError::Tied { own, other });
        }
        let (from, to) = (self.leader[variable.index()], self.leader[to.index()]);
        if from != to {
            self.leader
                .iter_mut()
                .filter(|leader| **leader == from)
                .for_each(|leader| *leader = to);
        }
        Ok(())
    }

    // ANCHOR: freeze
    /// Freezes the linearization point of a variable: residuals follow the variable, derivatives
    /// are taken as if it stood at `value`. What is then called the gradient is not that of the
    /// cost, so steps are judged by the cost alone.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`], also when `value` has another dimension.
    pub fn freeze<V: Manifold>(&mut self, variable: Key<V>, value: V) -> Result<(), ProblemError> {
        self.coordinates(variable)?;
        if !self.anchors.set(variable, value) {
            return Err(self.no_such(variable.index()));
        }
        self.frozen[variable.index()] = true;
        Ok(())
    }
    // ANCHOR_END: freeze

    /// Freezes the linearization points of some variables, given by number, where they stand.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`]; nothing is frozen then.
    pub fn freeze_here(&mut self, variables: &[usize]) -> Result<(), ProblemError> {
        if let Some(beyond) = variables.iter().find(|variable| **variable >= self.values.len()) {
            return Err(self.no_such(*beyond));
        }
        for &variable in variables {
            self.anchors.copy(&self.values, variable);
            self.frozen[variable] = true;
        }
        Ok(())
    }

    /// Freezes the linearization point of a variable at the value of one of other values, unless it is
    /// frozen already. Whether it was frozen now.
    pub(super) fn freeze_first(&mut self, variable: usize, at: (&Values, usize)) -> bool {
        let is_new = !self.frozen[variable];
        if is_new {
            self.anchors.copy_of(variable, at);
            self.frozen[variable] = true;
        }
        is_new
    }

    // ANCHOR: add_factor
    /// Adds a factor with its kernel, and gives its number.
    ///
    /// # Errors
    ///
    /// A [`ProblemError`] when its residual has no numbers, when it names a variable that does not exist,
    /// or one twice, when its derivatives do not fit the variables, or when the kernel's parameter is not
    /// positive and finite.
    pub fn add_factor<F: Factor<R>, const R: usize>(
        &mut self,
        factor: F,
        kernel: Kernel,
    ) -> Result<usize, ProblemError> {
        kernel.check()?;
        let number = self.factors;
        self.check::<F, R>(&factor.variables(), number)?;
        let at = self.group_of::<F, R>(kernel);
        let Group { factors, numbers, all } = &mut self.groups[at];
        if let Some(set) = set_mut::<F, R>(&mut **factors) {
            set.push(factor);
        }
        all.push(all.len() as u32);
        numbers.push(number);
        self.factors += 1;
        Ok(number)
    }

    /// The group of factors of this type with this kernel.
    fn group_of<F: Factor<R>, const R: usize>(&mut self, kernel: Kernel) -> usize {
        let is_it = |group: &mut Group| {
            set_mut::<F, R>(&mut *group.factors).is_some_and(|set| *set.kernel() == kernel)
        };
        self.groups.iter_mut().position(is_it).unwrap_or_else(|| {
            let factors = Box::new(FactorSet::<F, R>::new(kernel));
            self.groups.push(Group { factors, numbers: Vec::new(), all: Vec::new() });
            self.groups.len() - 1
        })
    }
    // ANCHOR_END: add_factor

    /// Takes the factors of one type with one kernel out of the problem that are to go, in the order in
    /// which they were added. Others keep their numbers.
    pub fn take_factors<F: Factor<R>, const R: usize>(
        &mut self,
        kernel: Kernel,
        goes: impl Fn(&F) -> bool,
    ) -> Vec<F> {
        let at = self.group_of::<F, R>(kernel);
        let Group { factors, numbers, all } = &mut self.groups[at];
        let taken = set_mut::<F, R>(&mut **factors).map(|set| set.take(goes, numbers));
        all.truncate(numbers.len());
        self.groups.retain(|group| !group.numbers.is_empty());
        taken.unwrap_or_default()
    }

    /// Adds a group of one factor.
    pub(super) fn add_group(
        &mut self,
        factors: Box<dyn FactorGroup>,
    ) -> Result<usize, ProblemError> {
        if factors.rows() == 0 {
            return Err(ProblemError::EmptyFactor { factor: self.factors });
        }
        Ok(self.append(factors))
    }

    /// Adds a group of one factor that has rows.
    pub(super) fn append(&mut self, factors: Box<dyn FactorGroup>) -> usize {
        let number = self.factors;
        self.groups.push(Group { factors, numbers: vec![number], all: vec![0] });
        self.factors += 1;
        number
    }

    /// Holds variables that exist, and those tied to them, and forgets all factors that name one of
    /// them. One that was held before goes with none.
    pub(crate) fn forget(&mut self, variables: &[usize]) {
        let columns = self.columns();
        let coordinates = |index| self.values.coordinates_of(index).unwrap_or_default();
        let gone: Vec<usize> =
            variables.iter().flat_map(|index| columns.select(coordinates(*index))).collect();
        let is_gone = |column: &usize| gone.contains(column);
        let goes: Vec<bool> = (0..self.values.len())
            .map(|index| columns.select(coordinates(index)).iter().any(is_gone))
            .collect();
        for (held, column) in self.held.iter_mut().zip(&columns.of) {
            *held |= column.as_ref().is_some_and(is_gone);
        }
        self.groups.iter_mut().for_each(|group| group.retain(|variable| !goes[variable]));
        self.groups.retain(|group| !group.numbers.is_empty());
    }

    /// Gives a variable that was taken out another life: it moves again, from `value`, and its
    /// linearization point is not frozen. No factor names it then.
    ///
    /// # Errors
    ///
    /// [`ProblemError::NoSuchVariable`], also when `value` has another dimension.
    pub fn renew<V: Manifold>(&mut self, variable: Key<V>, value: V) -> Result<(), ProblemError> {
        let coordinates = self.coordinates(variable)?;
        if !self.values.set(variable, value) {
            return Err(self.no_such(variable.index()));
        }
        self.held[coordinates].fill(false);
        self.frozen[variable.index()] = false;
        Ok(())
    }

    /// Whether a variable takes steps of its own: it is not tied to another.
    pub fn leads(&self, variable: usize) -> bool {
        self.leader.get(variable) == Some(&variable)
    }

    /// What has been kept of factors that are gone.
    pub(super) fn priors(&self) -> impl Iterator<Item = &LinearPrior> {
        self.groups.iter().filter_map(|group| {
            let any: &dyn Any = &*group.factors;
            any.downcast_ref()
        })
    }

    /// The values the variables begin at.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Lets the next solve begin elsewhere.
    ///
    /// # Errors
    ///
    /// [`SolveError::WrongValues`] when they are those of other variables.
    pub fn set_values(&mut self, values: Values) -> Result<(), SolveError> {
        self.check_values(&values)?;
        self.values = values;
        Ok(())
    }

    /// Which coordinates have a column in gradient, Hessian and Jacobian: those that are not held,
    /// in the order of the variables.
    pub fn columns(&self) -> Columns {
        let mut of = vec![None; self.values.dimension()];
        let (mut count, mut blocks) = (0, Vec::new());
        let coordinates = |index| self.values.coordinates_of(index).unwrap_or_default();
        // What is tied to something that is held is held too, whichever leads.
        let mut held = self.held.clone();
        for (index, &leader) in self.leader.iter().enumerate() {
            for (own, led) in coordinates(index).zip(coordinates(leader)) {
                held[led] |= self.held[own];
            }
        }
        for (index, &leader) in self.leader.iter().enumerate() {
            if leader == index {
                let start = count;
                for coordinate in coordinates(index).filter(|c| !held[*c]) {
                    of[coordinate] = Some(count);
                    count += 1;
                }
                blocks.extend((count > start).then_some(start..count));
            }
        }
        let mut shared = false;
        for (index, &leader) in self.leader.iter().enumerate().filter(|(i, leader)| i != *leader) {
            for (own, led) in coordinates(index).zip(coordinates(leader)) {
                of[own] = of[led];
                shared = true;
            }
        }
        Columns { of, count, blocks, shared }
    }

    /// The columns of a problem in which there is something to solve.
    ///
    /// # Errors
    ///
    /// [`SolveError::NoFactors`] and [`SolveError::NothingFree`].
    pub(super) fn columns_to_solve(&self) -> Result<Columns, SolveError> {
        let columns = self.columns();
        if self.is_empty() {
            return Err(SolveError::NoFactors);
        }
        if columns.count == 0 {
            return Err(SolveError::NothingFree);
        }
        Ok(columns)
    }

    /// A column for each coordinate that is not itself held, as if nothing were tied.
    pub(super) fn coordinate_columns(&self) -> Columns {
        let of = self.held.iter().enumerate().map(|(at, held)| (!held).then_some(at)).collect();
        Columns { of, count: self.held.len(), blocks: Vec::new(), shared: false }
    }

    // ANCHOR: cost
    /// The cost at `values`, infinite where a residual has no value. The values have to be those of this
    /// problem's variables ([`Values::fits`]). Implements {eq:robust-cost}.
    pub fn cost(&self, values: &Values) -> f64 {
        self.groups.iter().map(|group| group.factors.cost(&group.all, values)).sum()
    }
    // ANCHOR_END: cost

    /// How many factors there are.
    pub fn len(&self) -> usize {
        self.groups.iter().map(|group| group.numbers.len()).sum()
    }

    /// Whether there are no factors.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// How many numbers the residuals of all factors have together.
    pub fn rows(&self) -> usize {
        self.groups.iter().map(|group| group.factors.rows() * group.factors.count()).sum()
    }

    // ANCHOR: residual
    /// The whitened residuals of all factors at `values`, each times the root of its kernel's weight, in
    /// the order of the factors' types: the second part of [`Problem::jacobian`], without derivatives.
    ///
    /// # Errors
    ///
    /// [`SolveError::WrongValues`], [`SolveError::Undefined`] and [`SolveError::NotFinite`].
    pub fn residual(&self, values: &Values) -> Result<DVector<f64>, SolveError> {
        self.check_values(values)?;
        let mut all = Vec::with_capacity(self.rows());
        for Group { factors, numbers, all: places } in &self.groups {
            let undefined = |at: Undefined| SolveError::Undefined { factor: numbers[at.factor] };
            let before = all.len();
            factors.residuals(places, values, &mut all).map_err(undefined)?;
            if let Some(row) = all[before..].iter().position(|number| !number.is_finite()) {
                return Err(SolveError::NotFinite { factor: numbers[row / factors.rows()] });
            }
        }
        Ok(DVector::from_vec(all))
    }
    // ANCHOR_END: residual

    // ANCHOR: each_row
    /// Linearizes every factor and visits its rows: the residual, and the derivatives by all
    /// columns on which it depends. Every dense system and every dense Jacobian is made of these.
    pub(super) fn each_row(
        &self,
        at: Point,
        columns: &Columns,
        buffer: &mut Buffer,
        mut visit: impl FnMut(Row),
    ) -> Result<f64, SolveError> {
        let mut cost = 0.0;
        for (number, group) in self.groups.iter().enumerate() {
            cost += self.rows_of_group((number, &group.all), (at, columns), buffer, &mut visit)?;
        }
        Ok(cost)
    }
    // ANCHOR_END: each_row

    /// The same for the factors of which some variable passes.
    pub(super) fn each_row_of(
        &self,
        passes: impl Fn(usize) -> bool,
        at: Point,
        columns: &Columns,
        buffer: &mut Buffer,
        mut visit: impl FnMut(Row),
    ) -> Result<f64, SolveError> {
        let mut cost = 0.0;
        for (number, group) in self.groups.iter().enumerate() {
            let is_named = |place: &u32| {
                let mut names = false;
                group.factors.variables(*place as usize, &mut |variable| names |= passes(variable));
                names
            };
            let named: Vec<u32> = group.all.iter().copied().filter(is_named).collect();
            if !named.is_empty() {
                cost += self.rows_of_group((number, &named), (at, columns), buffer, &mut visit)?;
            }
        }
        Ok(cost)
    }

    /// Linearizes some factors of a group, visits their rows and gives their cost.
    fn rows_of_group(
        &self,
        (number, places): (usize, &[u32]),
        (at, columns): (Point, &Columns),
        Buffer { linear, coordinates: slots, entries }: &mut Buffer,
        visit: &mut impl FnMut(Row),
    ) -> Result<f64, SolveError> {
        let cost = self.linearize_group((number, places), at, linear)?;
        let factors = &self.groups[number].factors;
        for (place, factor) in places.iter().enumerate() {
            slots.clear();
            factors.variables(*factor as usize, &mut |index| {
                slots.push(self.values.coordinates_of(index).unwrap_or_default().start);
            });
            for row in place * linear.rows()..(place + 1) * linear.rows() {
                gather(linear, row, slots, columns, entries);
                visit(Row { residual: linear.residuals()[row], entries });
            }
        }
        Ok(cost)
    }

    // ANCHOR: each_group
    /// Linearizes all factors, group by group, and visits the groups. Returns the cost.
    pub(super) fn each_group(
        &self,
        at: Point,
        linear: &mut Linearized,
        mut visit: impl FnMut(usize, &Linearized),
    ) -> Result<f64, SolveError> {
        let mut cost = 0.0;
        for (number, group) in self.groups.iter().enumerate() {
            cost += self.linearize_group((number, &group.all), at, linear)?;
            visit(number, linear);
        }
        Ok(cost)
    }
    // ANCHOR_END: each_group

    /// Linearizes some factors of a group, and gives their cost.
    fn linearize_group(
        &self,
        (number, places): (usize, &[u32]),
        at: Point,
        linear: &mut Linearized,
    ) -> Result<f64, SolveError> {
        let group = &self.groups[number];
        let outcome = group.factors.linearize(places, at, linear);
        outcome.map_err(|at| self.undefined(number, at))?;
        match linear.not_finite() {
            Some(place) => {
                let factor = group.numbers[places[place] as usize];
                Err(SolveError::NotFinite { factor })
            }
            None => Ok(linear.cost),
        }
    }

    /// How many groups of factors there are.
    pub(super) fn group_count(&self) -> usize {
        self.groups.len()
    }

    /// The factors of one group.
    pub(super) fn group(&self, group: usize) -> &dyn FactorGroup {
        &*self.groups[group].factors
    }

    /// All factors: their group, and their place in it.
    pub(super) fn factors(&self) -> impl Iterator<Item = (&dyn FactorGroup, usize)> {
        let groups = self.groups.iter().map(|group| &*group.factors);
        groups.flat_map(|group| (0..group.count()).map(move |factor| (group, factor)))
    }

    /// The number of a factor in a group.
    pub(super) fn number(&self, group: usize, factor: u32) -> usize {
        self.groups[group].numbers[factor as usize]
    }

    /// The error that names a factor without a value.
    pub(super) fn undefined(&self, group: usize, at: Undefined) -> SolveError {
        SolveError::Undefined { factor: self.number(group, at.factor as u32) }
    }

    /// The error that names the first factor with a number that is not finite.
    pub(super) fn not_finite(&self, at: Point) -> SolveError {
        let outcome = self.each_group(at, &mut Linearized::default(), |_, _| ());
        outcome.err().unwrap_or(SolveError::OutOfRange)
    }

    /// Whether anything is frozen; if so, where derivatives are taken at first.
    pub(super) fn linearization_point(&self) -> Option<Values> {
        self.frozen.contains(&true).then(|| self.anchors.clone())
    }

    /// Lets a linearization point follow the values, except where it is frozen.
    pub(super) fn follow(&self, values: &Values, point: &mut Values) {
        for (index, _) in self.frozen.iter().enumerate().filter(|(_, frozen)| !**frozen) {
            point.copy(values, index);
        }
    }

    fn coordinates<V: Manifold>(&self, variable: Key<V>) -> Result<Range<usize>, ProblemError> {
        let index = variable.index();
        let known = self.values.key::<V>(index).filter(|known| known.place == variable.place);
        let coordinates = known.and_then(|_| self.values.coordinates_of(index));
        coordinates.ok_or_else(|| self.no_such(index))
    }

    fn no_such(&self, variable: usize) -> ProblemError {
        ProblemError::NoSuchVariable { variable, variables: self.values.len() }
    }

    /// Whether a factor fits the variables that it names.
    fn check<F: Factor<R>, const R: usize>(
        &self,
        keys: &<F::Variables as Variables>::Keys,
        factor: usize,
    ) -> Result<(), ProblemError> {
        if R == 0 {
            return Err(ProblemError::EmptyFactor { factor });
        }
        let mut named = Vec::new();
        F::Variables::indices(keys, &mut |index| named.push(index));
        if let Some(missing) = F::Variables::missing(keys, &self.values) {
            return Err(self.no_such(missing));
        }
        let columns = F::Jacobians::COLUMNS;
        check_repeated(&named, factor)?;
        let own =
            |variable: &usize| self.values.coordinates_of(*variable).unwrap_or_default().len();
        for slot in 0..named.len().max(columns.len()) {
            let dimension = named.get(slot).map_or(0, own);
            let columns = columns.get(slot).copied().unwrap_or(0);
            if columns != dimension {
                return Err(ProblemError::Columns { factor, slot, columns, dimension });
            }
        }
        Ok(())
    }

    pub(super) fn check_values(&self, values: &Values) -> Result<(), SolveError> {
        let (given, expected) = (values.len(), self.values.len());
        let fits = self.values.fits(values);
        fits.then_some(()).ok_or(SolveError::WrongValues { given, expected })
    }
}

/// That a factor names no variable twice.
pub(super) fn check_repeated(variables: &[usize], factor: usize) -> Result<(), ProblemError> {
    let mut each = variables.iter().enumerate();
    match each.find(|(slot, variable)| variables[..*slot].contains(variable)) {
        Some((_, &variable)) => Err(ProblemError::RepeatedVariable { factor, variable }),
        None => Ok(()),
    }
}

/// The factors, if they are of this type.
fn set_mut<F: Factor<R>, const R: usize>(
    group: &mut dyn FactorGroup,
) -> Option<&mut FactorSet<F, R>> {
    let any: &mut dyn Any = group;
    any.downcast_mut()
}

/// One row of a problem's Jacobian.
pub(super) struct Row<'a> {
    pub(super) residual: f64,
    /// Columns and derivatives; every column once.
    pub(super) entries: &'a [(usize, f64)],
}

/// Memory for linearizing.
#[derive(Debug, Clone, Default)]
pub(super) struct Buffer {
    linear: Linearized,
    coordinates: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

// ANCHOR: gather
/// Collects a row of the linearized factors: the derivatives in each slot by the columns of its
/// variable. What is held has no column; what is tied shares one, and only then it is looked for.
fn gather(
    linear: &Linearized,
    row: usize,
    slots: &[usize],
    columns: &Columns,
    entries: &mut Vec<(usize, f64)>,
) {
    entries.clear();
    for (slot, &start) in slots.iter().enumerate() {
        let width = linear.columns(slot);
        let slopes = &linear.jacobian(slot)[row * width..(row + 1) * width];
        for (column, slope) in columns.of[start..].iter().zip(slopes) {
            let Some(column) = *column else { continue };
            let known = match columns.shared {
                true => entries.iter_mut().find(|(other, _)| *other == column),
                false => None,
            };
            match known {
                Some((_, sum)) => *sum += slope,
                None => entries.push((column, *slope)),
            }
        }
    }
}
// ANCHOR_END: gather

/// Which coordinates of a problem's variables have a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Columns {
    /// The column of each coordinate; `None` for one that is held.
    pub of: Vec<Option<usize>>,
    /// How many columns there are.
    pub count: usize,
    /// The columns of each variable that has some, those that are tied as one.
    pub(super) blocks: Vec<Range<usize>>,
    /// Whether coordinates of different variables may have the same column.
    pub(super) shared: bool,
}

impl Columns {
    /// A step of all coordinates, from one of all columns. What is held does not move.
    pub fn spread(&self, step: &[f64], into: &mut [f64]) {
        for (into, column) in into.iter_mut().zip(&self.of) {
            *into = column.map_or(0.0, |column| step[column]);
        }
    }

    /// The columns of some coordinates.
    pub fn select(&self, coordinates: Range<usize>) -> Vec<usize> {
        self.of[coordinates].iter().flatten().copied().collect()
    }

    /// Which block the coordinates of a variable have; `None` when all of them are held.
    pub(super) fn block_of(&self, coordinates: Range<usize>) -> Option<usize> {
        let first = self.of[coordinates].iter().flatten().next()?;
        Some(self.block_with(*first))
    }

    /// Which block a column is in.
    pub(super) fn block_with(&self, column: usize) -> usize {
        self.blocks.partition_point(|block| block.end <= column)
    }
}

/// Why a variable or factor cannot be part of a problem.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ProblemError {
    /// A key is that of another problem, a number is too large, or a value has another dimension.
    #[error(
        "variable {variable} is not one of the problem's {variables}, or not of this kind and dimension; \
         name one of those that were added"
    )]
    NoSuchVariable {
        /// The number given.
        variable: usize,
        /// The number of variables.
        variables: usize,
    },
    /// A coordinate is out of range.
    #[error("coordinate {coordinate} does not exist; a step has {dimension}, counted from zero")]
    NoSuchCoordinate {
        /// The coordinate given.
        coordinate: usize,
        /// How many there are.
        dimension: usize,
    },
    /// Variables that are to move alike have steps of different lengths.
    #[error("a step of {own} numbers cannot follow one of {other}; tie variables of one dimension")]
    Tied {
        /// The dimension of the variable.
        own: usize,
        /// The dimension of that which it should follow.
        other: usize,
    },
    /// A factor names a variable twice.
    #[error("factor {factor} names variable {variable} twice; add both derivatives in one block")]
    RepeatedVariable {
        /// The factor's number.
        factor: usize,
        /// The variable's number.
        variable: usize,
    },
    /// A factor has no numbers.
    #[error("factor {factor} has no numbers; give it at least one or leave it out")]
    EmptyFactor {
        /// The factor's number.
        factor: usize,
    },
    /// The derivatives by a variable have another number of columns than its step has numbers.
    #[error(
        "factor {factor} has derivatives of {columns} columns by its variable {slot}, whose step \
         has {dimension} numbers"
    )]
    Columns {
        /// The factor's number.
        factor: usize,
        /// Which of its variables, counted from zero.
        slot: usize,
        /// Columns of the derivatives.
        columns: usize,
        /// The dimension of the variable.
        dimension: usize,
    },
    /// A prior is of another shape than its variables, or not finite.
    #[error(
        "a prior's root of {rows} by {columns} and its offset of {numbers} numbers do not fit variables \
         of {dimension} coordinates, or a number is not finite; give finite numbers, one column for \
         each coordinate, also of those that are held, and one offset for each row"
    )]
    Root {
        /// Rows of the root.
        rows: usize,
        /// Columns of the root.
        columns: usize,
        /// Numbers of the offset.
        numbers: usize,
        /// How many coordinates the variables have together.
        dimension: usize,
    },
    /// A kernel has an impossible parameter.
    #[error(transparent)]
    Kernel(#[from] KernelError),
}
