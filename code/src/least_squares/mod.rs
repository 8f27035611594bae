//! Nonlinear least squares on manifolds: what contradicting measurements say together, and
//! how sure that is.
//!
//! A [`Problem`] has variables, each a point of a [`Manifold`], and residual blocks. A
//! [`Residual`] is what a measurement model gives less what was measured, *whitened*: scaled
//! so that its noise has the unit covariance. With r the residual, J its derivative by the
//! step of [`Manifold::retract`] and ρ a [`Kernel`],
//!
//! - the cost is Σ ρ(‖r‖), which is ½ Σ ‖r‖² for [`Kernel::Squared`];
//! - its gradient is g = Σ w Jᵀ r, with the weight w = ρ'(‖r‖) / ‖r‖;
//! - a Gauss-Newton step δ solves H δ = −g, with H = Σ w Jᵀ J.
//!
//! J is the Jacobian of r itself. Whoever writes r = z − h(x) instead of h(x) − z may do so,
//! but then J is minus the Jacobian of h: negate both or neither.
//!
//! The normal equations are dense, which is right for tens of variables and wrong for
//! thousands of landmarks: their structure needs a solver of its own.

mod kernel;
mod normal_equations;
mod problem;
mod residual;
mod solver;
mod variable;
mod whitening;

pub use kernel::{Kernel, KernelError};
pub use normal_equations::{Covariance, FREE_BELOW, NormalEquations, SingularSystem, Step};
pub use problem::{Problem, ProblemError};
pub use residual::{Evaluation, Residual, Undefined};
pub use solver::{Iteration, Method, Options, Report, Solution, SolveError, Stop};
pub use variable::{Manifold, PoseOrPoint};
pub use whitening::{WhiteningError, sqrt_information};
