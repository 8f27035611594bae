//! Gauss-Newton and Levenberg-Marquardt, and an account of what they did.

use std::fmt;
use std::mem::swap;

use thiserror::Error;

use super::normal_equations::{NormalEquations, SingularSystem, Step};
use super::problem::{Problem, Workspace};
use super::variable::Manifold;

/// How steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Every step is the minimum of the linearized problem, and is taken.
    GaussNewton,
    /// Steps are damped, and refused when the cost does not fall.
    LevenbergMarquardt {
        /// The first damping, relative to the Hessian's diagonal.
        initial_damping: f64,
    },
}

/// How to solve a problem. `Options::default()` is Levenberg-Marquardt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// How steps are chosen.
    pub method: Method,
    /// The number of steps that may be tried, refused ones included.
    pub max_iterations: usize,
    /// Stop when the scaled gradient is shorter; see [`NormalEquations::gradient_norm`].
    pub gradient_tolerance: f64,
    /// Stop when the next step would be shorter, measured as in [`Step::norm`].
    pub step_tolerance: f64,
    /// Stop when the next step promises to lower the cost by less than this part of it.
    pub decrease_tolerance: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::LevenbergMarquardt { initial_damping: 1e-4 },
            max_iterations: 100,
            gradient_tolerance: 1e-8,
            step_tolerance: 1e-8,
            decrease_tolerance: 1e-12,
        }
    }
}

impl Options {
    /// Gauss-Newton, otherwise as by default.
    pub fn gauss_newton() -> Self {
        Self { method: Method::GaussNewton, ..Self::default() }
    }
}

// ANCHOR: iteration
/// One step that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// The cost before it.
    pub cost: f64,
    /// The norm of the scaled gradient before it.
    pub gradient_norm: f64,
    /// The damping λ; zero for Gauss-Newton.
    pub damping: f64,
    /// The scaled length of the step.
    pub step_norm: f64,
    /// The cost after it, or `None` when a residual was undefined or not finite there.
    pub trial_cost: Option<f64>,
    /// The decrease of the cost over the predicted one, where there is a cost: {eq:gain-ratio}.
    pub gain_ratio: Option<f64>,
    /// Whether the step was taken.
    pub accepted: bool,
}
// ANCHOR_END: iteration

// ANCHOR: stop
/// Why a solver stopped. The first three are convergence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The gradient is below its tolerance.
    GradientSmall,
    /// The next step would be below its tolerance, and not because of damping.
    StepSmall,
    /// The next step promises no decrease of the cost worth having, and not because of damping.
    DecreaseSmall,
    /// The number of iterations was used up.
    IterationLimit,
    /// No damping, however large, gives a step that lowers the cost, and the gradient is not zero.
    Stalled,
    /// A Gauss-Newton step led to where a residual is undefined or not finite.
    LeftDomain,
}
// ANCHOR_END: stop

impl Stop {
    /// Whether the values are a stationary point, to the tolerances.
    pub fn is_convergence(&self) -> bool {
        matches!(self, Self::GradientSmall | Self::StepSmall | Self::DecreaseSmall)
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            Self::GradientSmall => "converged: the gradient is below its tolerance",
            Self::StepSmall => "converged: the next step would be below its tolerance",
            Self::DecreaseSmall => "converged: the next step promises no further decrease",
            Self::IterationLimit => "not converged: the iterations are used up",
            Self::Stalled => {
                "not converged: no step lowers the cost although the gradient is not zero; check \
                 the Jacobians"
            }
            Self::LeftDomain => {
                "not converged: the last step led to where a residual is undefined or not finite; \
                 start nearer or use Levenberg-Marquardt"
            }
        })
    }
}

/// What a solver did.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Every step that was tried, in order.
    pub iterations: Vec<Iteration>,
    /// The cost at the end.
    pub cost: f64,
    /// The norm of the scaled gradient at the end.
    pub gradient_norm: f64,
    /// Directions that the measurements leave free at the end. Damping hides them from the
    /// solver, and this is where they show.
    pub free_directions: usize,
    /// Why it stopped.
    pub stop: Stop,
}

/// Values of all variables, and how they were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution<V> {
    /// The best values found, by variable; for Gauss-Newton, the last.
    pub values: Vec<V>,
    /// How they were found.
    pub report: Report,
}

/// Above this damping, relative to the Hessian's diagonal, the search for a step is given up.
const LARGEST_DAMPING: f64 = 1e12;
/// Below it, damping is lost in rounding.
const SMALLEST_DAMPING: f64 = 1e-12;
/// A step is taken when the cost falls by at least this part of what was predicted.
const SMALLEST_GAIN: f64 = 1e-4;

// ANCHOR: damping
/// How strongly steps are damped, and how that changes.
struct Damping {
    value: f64,
    /// By which the next refused step raises it.
    growth: f64,
}

impl Damping {
    /// After a step that was taken with this gain, less of it, the better the prediction was.
    /// After one that was refused, more, and faster every time.
    fn learn(&mut self, gain: Option<f64>) {
        if let Some(gain) = gain {
            let factor = (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            self.value = (self.value * factor).max(SMALLEST_DAMPING);
            self.growth = 2.0;
        } else {
            self.value *= self.growth;
            self.growth *= 2.0;
        }
    }
}
// ANCHOR_END: damping

impl<V: Manifold> Problem<V> {
    /// Minimizes the cost, beginning at the problem's values, which stay as they are.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when there is nothing to solve, when a residual is undefined, not finite or
    /// of the wrong shape at the beginning, or when a Gauss-Newton step is not determined. What
    /// goes wrong later ends the search and is told by [`Report::stop`].
    pub fn solve(&self, options: &Options) -> Result<Solution<V>, SolveError> {
        options.check()?;
        let workspace = Workspace::of(self)?;
        let empty = NormalEquations::zeros(workspace.layout.dimension);
        let mut search = Search {
            problem: self,
            values: self.values().to_vec(),
            trial: self.values().to_vec(),
            trial_system: empty.clone(),
            system: empty,
            workspace,
            iterations: Vec::with_capacity(options.max_iterations.min(1000)),
        };
        self.linearize_into(&search.values, &mut search.workspace, &mut search.system)?;
        let stop = match options.method {
            Method::GaussNewton => search.gauss_newton(options)?,
            Method::LevenbergMarquardt { initial_damping } => {
                search.levenberg_marquardt(options, initial_damping)?
            }
        };
        Ok(search.finish(stop))
    }
}

/// The state of a search: where it is, and where it might go.
struct Search<'a, V> {
    problem: &'a Problem<V>,
    values: Vec<V>,
    system: NormalEquations,
    trial: Vec<V>,
    trial_system: NormalEquations,
    workspace: Workspace,
    iterations: Vec<Iteration>,
}

impl<V: Manifold> Search<'_, V> {
    // ANCHOR: gauss_newton
    fn gauss_newton(&mut self, options: &Options) -> Result<Stop, SolveError> {
        loop {
            if let Some(stop) = self.before_step(options) {
                return Ok(stop);
            }
            let Some(step) = self.system.step(0.0) else {
                return Err(self
                    .system
                    .singular()
                    .map_or(SolveError::OutOfRange, SolveError::Singular));
            };
            if let Some(stop) = self.after_step(&step, options) {
                return Ok(stop);
            }
            let trial_cost = self.try_step(&step)?;
            self.record(0.0, &step, trial_cost, trial_cost.is_some());
            if trial_cost.is_none() {
                return Ok(Stop::LeftDomain);
            }
            self.take_trial();
        }
    }
    // ANCHOR_END: gauss_newton

    // ANCHOR: levenberg_marquardt
    fn levenberg_marquardt(&mut self, options: &Options, initial: f64) -> Result<Stop, SolveError> {
        let mut damping = Damping { value: initial, growth: 2.0 };
        while damping.value <= LARGEST_DAMPING {
            if let Some(stop) = self.before_step(options) {
                return Ok(stop);
            }
            let Some(step) = self.system.step(damping.value) else {
                damping.learn(None);
                continue;
            };
            // Under strong damping every step is small; that says nothing about the minimum.
            if let Some(stop) = self.after_step(&step, options).filter(|_| damping.value <= 1.0) {
                return Ok(stop);
            }
            let trial_cost = self.try_step(&step)?;
            let gain = self.gain_ratio(&step, trial_cost).filter(|gain| *gain > SMALLEST_GAIN);
            self.record(damping.value, &step, trial_cost, gain.is_some());
            if gain.is_some() {
                self.take_trial();
            }
            damping.learn(gain);
        }
        Ok(Stop::Stalled)
    }
    // ANCHOR_END: levenberg_marquardt

    // ANCHOR: stopping
    /// Whether to stop where we are.
    fn before_step(&self, options: &Options) -> Option<Stop> {
        if self.system.gradient_norm() <= options.gradient_tolerance {
            Some(Stop::GradientSmall)
        } else if self.iterations.len() >= options.max_iterations {
            Some(Stop::IterationLimit)
        } else {
            None
        }
    }

    /// Whether this step is still worth taking.
    fn after_step(&self, step: &Step, options: &Options) -> Option<Stop> {
        if step.norm <= options.step_tolerance {
            Some(Stop::StepSmall)
        } else if step.predicted_decrease <= options.decrease_tolerance * self.system.cost {
            Some(Stop::DecreaseSmall)
        } else {
            None
        }
    }
    // ANCHOR_END: stopping

    // ANCHOR: try_step
    /// Moves every free variable by its part of the step, and gives the cost there, or `None`
    /// where a residual has none.
    fn try_step(&mut self, step: &Step) -> Result<Option<f64>, SolveError> {
        let moved = self.trial.iter_mut().zip(&self.values).zip(&self.workspace.layout.rows);
        for ((trial, value), rows) in moved {
            if let Some(rows) = rows {
                *trial = value.retract(&step.step.as_slice()[rows.clone()]);
            }
        }
        let outcome =
            self.problem.linearize_into(&self.trial, &mut self.workspace, &mut self.trial_system);
        match outcome {
            Ok(()) => Ok(Some(self.trial_system.cost)),
            Err(error) if error.is_about_the_point() => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn take_trial(&mut self) {
        swap(&mut self.values, &mut self.trial);
        swap(&mut self.system, &mut self.trial_system);
    }
    // ANCHOR_END: try_step

    fn gain_ratio(&self, step: &Step, trial_cost: Option<f64>) -> Option<f64> {
        Some((self.system.cost - trial_cost?) / step.predicted_decrease)
    }

    fn record(&mut self, damping: f64, step: &Step, trial_cost: Option<f64>, accepted: bool) {
        self.iterations.push(Iteration {
            cost: self.system.cost,
            gradient_norm: self.system.gradient_norm(),
            damping,
            step_norm: step.norm,
            trial_cost,
            gain_ratio: self.gain_ratio(step, trial_cost),
            accepted,
        });
    }

    fn finish(self, stop: Stop) -> Solution<V> {
        let report = Report {
            iterations: self.iterations,
            cost: self.system.cost,
            gradient_norm: self.system.gradient_norm(),
            free_directions: self.system.free_directions(),
            stop,
        };
        Solution { values: self.values, report }
    }
}

impl Options {
    fn check(&self) -> Result<(), SolveError> {
        let mut numbers = vec![
            ("gradient_tolerance", self.gradient_tolerance),
            ("step_tolerance", self.step_tolerance),
            ("decrease_tolerance", self.decrease_tolerance),
        ];
        if let Method::LevenbergMarquardt { initial_damping } = self.method {
            if initial_damping == 0.0 {
                return Err(SolveError::Option { name: "initial_damping", value: initial_damping });
            }
            numbers.push(("initial_damping", initial_damping));
        }
        let is_wrong = |value: f64| !(value >= 0.0 && value.is_finite());
        match numbers.into_iter().find(|(_, value)| is_wrong(*value)) {
            Some((name, value)) => Err(SolveError::Option { name, value }),
            None => Ok(()),
        }
    }
}

/// Why a problem cannot be solved, or not from here.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SolveError {
    /// There is nothing to minimize.
    #[error("the problem has no residuals; add at least one")]
    NoResiduals,
    /// There is nothing to move.
    #[error("the problem has no free variable; add one or leave one unfixed")]
    NothingFree,
    /// Values belong to another problem.
    #[error(
        "{given} values do not fit the problem's {expected} variables; give one for each, of the \
         same dimension"
    )]
    WrongValues {
        /// How many were given.
        given: usize,
        /// How many variables there are.
        expected: usize,
    },
    /// A residual has no value where the search begins.
    #[error("residual {residual} is undefined at these values; begin elsewhere or remove it")]
    Undefined {
        /// The residual's index.
        residual: usize,
    },
    /// A residual or its Jacobian is NaN or infinite where the search begins.
    #[error(
        "residual {residual} or its Jacobian is not finite at these values; look for a NaN in its \
         measurement or a division by zero"
    )]
    NotFinite {
        /// The residual's index.
        residual: usize,
    },
    /// The squares of finite residuals or derivatives are infinite, or zero.
    #[error(
        "a sum of squares is too large or too small for a number; whiten the residuals and choose \
         units in which the variables are neither huge nor tiny"
    )]
    OutOfRange,
    /// A residual wrote something of the wrong shape.
    #[error(
        "residual {residual} wrote {what} of {}×{} numbers where {}×{} belong",
        given.0, given.1, expected.0, expected.1
    )]
    WrongShape {
        /// The residual's index.
        residual: usize,
        /// What was written.
        what: &'static str,
        /// Its rows and columns.
        given: (usize, usize),
        /// The rows and columns that belong there.
        expected: (usize, usize),
    },
    /// The step is not determined.
    #[error(transparent)]
    Singular(#[from] SingularSystem),
    /// An option has an impossible value.
    #[error("option {name} is {value}; tolerances are zero or positive, the damping is positive")]
    Option {
        /// Its name.
        name: &'static str,
        /// The value given.
        value: f64,
    },
}

impl SolveError {
    /// Whether it may go away at other values.
    fn is_about_the_point(&self) -> bool {
        matches!(self, Self::Undefined { .. } | Self::NotFinite { .. } | Self::OutOfRange)
    }
}
