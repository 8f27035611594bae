//! Nonlinear least squares on manifolds: what contradicting measurements say together, and
//! how sure that is.
//!
//! A [`Problem`] has variables, each a point of a [`Manifold`], and factors. A [`Factor`] is what a
//! measurement model predicts less what was measured, *whitened*: scaled so that its noise has the
//! unit covariance. With r the residual, J its derivative by the step of [`Manifold::retract`] and
//! ρ a [`Kernel`],
//!
//! - the cost is Σ ρ(‖r‖), which is ½ Σ ‖r‖² for [`Kernel::Squared`];
//! - its gradient is g = Σ w Jᵀ r, with the weight w = ρ'(‖r‖) / ‖r‖;
//! - a Gauss-Newton step δ solves H δ = −g, with H = Σ w Jᵀ J.
//!
//! A [`Search`] goes from step to step over any [`LinearSystem`]: [`Dense`] normal equations are
//! right for hundreds of columns, [`LandmarkElimination`] for thousands of landmarks of which each
//! factor sees one, and [`Fronts`] for whatever there is, in any order.
//! [`Problem::null_space`] says what the factors leave free, whichever system solves for the rest.

mod assembly;
mod blocks;
mod cholesky;
mod covariance;
mod elimination_tree;
mod factor;
mod front;
mod fronts;
mod group;
mod kernel;
mod landmark_rows;
mod landmarks;
mod linear_prior;
mod linearized;
mod manifold;
mod mirrors;
mod normal_equations;
mod null_space;
mod ordering;
mod orthogonal;
mod problem;
mod singular;
mod solver;
mod sparse_rows;
mod spectrum;
mod square_root;
mod structure;
mod tiles;
mod values;
mod whitening;

pub use cholesky::SparseCholesky;
pub use covariance::Covariance;
pub use factor::{Factor, Jacobians, Variables};
pub use fronts::Fronts;
pub use group::{FactorGroup, Point, Undefined};
pub use kernel::{Kernel, KernelError};
pub use landmarks::{LandmarkElimination, Singular};
pub use linear_prior::LinearPrior;
pub use linearized::Linearized;
pub use manifold::Manifold;
pub(crate) use normal_equations::LOST_PIVOT;
pub use normal_equations::{Dense, NormalEquations, Step};
pub use null_space::{NullSpace, NullSpaceError, RANK_TOLERANCE, SingularSystem};
pub use problem::{Columns, Problem, ProblemError};
pub(crate) use singular::right_singular;
pub(crate) use solver::LARGEST_DAMPING;
pub use solver::{
    Iteration, LinearSystem, Method, Options, Prediction, Report, Search, Solution, SolveError,
    Stop,
};
pub(crate) use sparse_rows::SparseRows;
pub use spectrum::Spectrum;
pub use square_root::eliminate;
pub(crate) use square_root::eliminate_fronts;
pub use values::{Key, Values};
pub use whitening::{WhiteningError, sqrt_information};
