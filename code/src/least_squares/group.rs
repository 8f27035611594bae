//! Factors of one kind, asked together.

use std::any::Any;

use super::linearized::Linearized;
use super::{Factor, Jacobians, Kernel, Values, Variables};

/// Where factors are evaluated.
#[derive(Debug, Clone, Copy)]
pub struct Point<'a> {
    /// Where residuals are evaluated.
    pub values: &'a Values,
    /// Where derivatives are evaluated, when that is another point: the linearization point that
    /// somebody froze.
    pub frozen: Option<&'a Values>,
}

/// A factor of a group that has no value where it was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Undefined {
    /// Its place in the group.
    pub factor: usize,
}

// ANCHOR: group
/// Factors of one kind. A call evaluates many of them, so that the calls inside are known when
/// compiling.
pub trait FactorGroup: Any + Send + Sync {
    /// How many factors there are.
    fn count(&self) -> usize;

    /// How many numbers the residual of each has.
    fn rows(&self) -> usize;

    /// The dimension of each of a factor's variables.
    fn columns(&self) -> &[usize];

    /// Visits the numbers of the variables of a factor, in the order of its slots.
    fn variables(&self, factor: usize, visit: &mut dyn FnMut(usize));

    /// Forgets all factors but those whose place it should keep.
    fn retain(&mut self, keep: &dyn Fn(usize) -> bool);

    /// The cost of some factors. Infinite where a residual has no value.
    fn cost(&self, factors: &[u32], values: &Values) -> f64;

    /// Appends the whitened residuals of some factors, as [`FactorGroup::linearize`] has them.
    ///
    /// # Errors
    ///
    /// [`Undefined`] names the first that has no value.
    fn residuals(
        &self,
        factors: &[u32],
        values: &Values,
        into: &mut Vec<f64>,
    ) -> Result<(), Undefined>;

    /// Linearizes some factors.
    ///
    /// # Errors
    ///
    /// [`Undefined`] names the first that has no value.
    fn linearize(&self, factors: &[u32], at: Point, into: &mut Linearized)
    -> Result<(), Undefined>;
}
// ANCHOR_END: group

/// Factors of one type with one kernel.
pub struct FactorSet<F, const R: usize> {
    kernel: Kernel,
    factors: Vec<F>,
}

impl<F: Factor<R>, const R: usize> FactorSet<F, R> {
    /// No factors yet.
    pub fn new(kernel: Kernel) -> Self {
        Self { kernel, factors: Vec::new() }
    }

    /// The kernel of all of them.
    pub fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// Adds a factor and gives its place.
    pub fn push(&mut self, factor: F) -> usize {
        self.factors.push(factor);
        self.factors.len() - 1
    }

    /// Takes the factors out that are to go, and their numbers away from those of all.
    pub(super) fn take(&mut self, goes: impl Fn(&F) -> bool, numbers: &mut Vec<usize>) -> Vec<F> {
        let mut place = 0..self.factors.len();
        numbers.retain(|_| place.next().is_some_and(|place| !goes(&self.factors[place])));
        self.factors.extract_if(.., |factor| goes(factor)).collect()
    }
}

impl<F: Factor<R>, const R: usize> FactorGroup for FactorSet<F, R> {
    fn count(&self) -> usize {
        self.factors.len()
    }

    fn rows(&self) -> usize {
        R
    }

    fn columns(&self) -> &[usize] {
        F::Jacobians::COLUMNS
    }

    fn variables(&self, factor: usize, visit: &mut dyn FnMut(usize)) {
        F::Variables::indices(&self.factors[factor].variables(), visit);
    }

    fn retain(&mut self, keep: &dyn Fn(usize) -> bool) {
        let mut place = 0..self.factors.len();
        self.factors.retain(|_| place.next().is_some_and(keep));
    }

    // ANCHOR: group_cost
    fn cost(&self, factors: &[u32], values: &Values) -> f64 {
        let lists = F::Variables::lists(values);
        let cost = |factor: &u32| {
            let factor = &self.factors[*factor as usize];
            let residual = factor.residual(F::Variables::pick(lists, &factor.variables()));
            residual.map_or(f64::INFINITY, |r| self.kernel.cost_of_square(r.norm_squared()))
        };
        factors.iter().map(cost).sum()
    }
    // ANCHOR_END: group_cost

    fn residuals(
        &self,
        factors: &[u32],
        values: &Values,
        into: &mut Vec<f64>,
    ) -> Result<(), Undefined> {
        let lists = F::Variables::lists(values);
        for &index in factors {
            let factor = &self.factors[index as usize];
            let residual = factor.residual(F::Variables::pick(lists, &factor.variables()));
            let residual = residual.ok_or(Undefined { factor: index as usize })?;
            let weight = self.kernel.root_weight_of_square(residual.norm_squared());
            into.extend(residual.iter().map(|number| weight * number));
        }
        Ok(())
    }

    // ANCHOR: group_linearize
    fn linearize(
        &self,
        factors: &[u32],
        at: Point,
        into: &mut Linearized,
    ) -> Result<(), Undefined> {
        into.begin(factors.len(), R, F::Jacobians::COLUMNS);
        let lists = F::Variables::lists(at.values);
        let frozen = at.frozen.map(F::Variables::lists);
        for (place, &index) in factors.iter().enumerate() {
            let factor = &self.factors[index as usize];
            let keys = factor.variables();
            let point = F::Variables::pick(frozen.unwrap_or(lists), &keys);
            let undefined = Undefined { factor: index as usize };
            let (mut residual, jacobians) = factor.linearize(point).ok_or(undefined)?;
            if frozen.is_some() {
                let here = F::Variables::pick(lists, &keys);
                residual = factor.residual(here).ok_or(undefined)?;
            }
            let squared = residual.norm_squared();
            let root_weight = self.kernel.root_weight_of_square(squared);
            into.cost += self.kernel.cost_of_square(squared);
            into.write_residual(place, root_weight, &residual);
            jacobians.write(place, root_weight, into);
        }
        Ok(())
    }
    // ANCHOR_END: group_linearize
}
