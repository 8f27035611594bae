//! From a problem to blocks, and from blocks to a prior.

use super::{Block, Blocks, Information, MarginalizationError, SquareRoot};
use crate::least_squares::{LinearPrior, Problem, ProblemError, Values};

impl SquareRoot<f64> {
    // ANCHOR: of_problem
    /// All factors of a problem as they are linearized at `values`. Blocks are named by the numbers of
    /// the variables and have the coordinates that are not held, as steps from `values`; variables
    /// that are held have none, and of tied ones the leader has it.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::NoneNamed`] when nothing is free,
    /// [`MarginalizationError::Linearization`] when the problem cannot be linearized there.
    pub fn of_problem(problem: &Problem, values: &Values) -> Result<Self, MarginalizationError> {
        let columns = problem.columns();
        let block = |name: usize| {
            let coordinates = values.coordinates_of(name).unwrap_or_default();
            Block { name, dimension: columns.select(coordinates).len() }
        };
        let (root, offset) = problem.jacobian(values)?;
        let leaders = (0..values.len()).filter(|variable| problem.leads(*variable));
        let blocks = leaders.map(block).filter(|block| block.dimension > 0).collect();
        Self::new(Blocks::new(blocks)?, root, offset)
    }
    // ANCHOR_END: of_problem

    // ANCHOR: into_prior
    /// The prior that says this of variables which stand at `anchors`, where x is zero. Blocks are named
    /// by the variables' numbers.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Prior`] when a variable does not exist, has another dimension than its
    /// block, some of its coordinates being held, or when there are no rows.
    pub fn into_prior(self, anchors: &Values) -> Result<LinearPrior, MarginalizationError> {
        let names: Vec<usize> = self.blocks().names().collect();
        for (slot, (name, own)) in names.iter().zip(self.blocks().ranges()).enumerate() {
            let dimension = anchors.coordinates_of(*name).map_or(own.len(), |it| it.len());
            if dimension != own.len() {
                let columns = own.len();
                return Err(ProblemError::Columns { factor: 0, slot, columns, dimension }.into());
            }
        }
        let (root, offset) = (self.root().clone(), self.offset().clone());
        Ok(LinearPrior::of_root(anchors, &names, root, offset)?)
    }
    // ANCHOR_END: into_prior
}

impl Information<f64> {
    /// The prior that says this, with the Cholesky factor as its root.
    ///
    /// # Errors
    ///
    /// As those of [`SquareRoot::of_information`] and [`SquareRoot::into_prior`].
    pub fn into_prior(self, anchors: &Values) -> Result<LinearPrior, MarginalizationError> {
        SquareRoot::of_information(&self)?.into_prior(anchors)
    }
}
