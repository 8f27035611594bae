//! Gauss-Newton and Levenberg-Marquardt over any linear system, and an account of what they did.

use std::fmt;
use std::mem::swap;

use thiserror::Error;

use super::group::Point;
use super::normal_equations::Dense;
use super::null_space::{NullSpaceError, SingularSystem};
use super::problem::Problem;
use super::{Covariance, Values};

// ANCHOR: linear_system
/// The normal equations of a problem, in whatever form they are kept.
pub trait LinearSystem {
    /// Takes note of a new point, and gives the cost there, where all factors are asked for it.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when a residual is undefined or not finite there.
    fn linearize(&mut self, problem: &Problem, at: Point) -> Result<Option<f64>, SolveError>;

    /// Writes the step of all coordinates for a damping relative to the Hessian's diagonal, from
    /// the point of the last [`LinearSystem::linearize`]. `None` when the equations are singular.
    fn step(&mut self, damping: f64, into: &mut [f64]) -> Option<Prediction>;

    /// Whether a pivot of the last step is so small that, without damping, the Jacobian has to say
    /// whether the step is determined.
    fn is_suspicious(&self) -> bool;

    /// The norm of the scaled gradient at that point.
    fn gradient_norm(&self) -> f64;

    /// The covariance of an estimate that stands at a point; see [`Problem::covariance`].
    ///
    /// # Errors
    ///
    /// As those of [`Problem::covariance`].
    fn covariance(&mut self, problem: &Problem, at: Point) -> Result<Covariance, SolveError>;
}

/// What a linear system says of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The length of the step, each coordinate measured by what changes one whitened unit.
    pub step_norm: f64,
    /// By how much the cost falls if the residuals are linear: {eq:predicted-decrease}.
    pub predicted_decrease: f64,
    /// The norm of the scaled gradient before the step. Its entries say by how many of its own
    /// standard deviations each coordinate alone would still move, all others held.
    pub gradient_norm: f64,
}
// ANCHOR_END: linear_system

/// What the diagonal of the normal equations is measured by, what damping adds to it, and what a
/// pivot says. Every sparse system asks here.
pub(super) struct Pivots;

impl Pivots {
    /// Pivots below this fraction of the curvature before elimination are rounding errors.
    pub(super) const ROUNDING: f64 = 1e-14;
    /// Pivots below this many of those ask whether the Jacobian has full rank.
    const SUSPICIOUS: f64 = 1e6;
    /// By such a part rounding may change a covariance.
    pub(super) const SHARP: f64 = 0.1;
    /// No curvature counts as smaller than this when it is damped, so that an unknown that no
    /// factor depends on stays where it is.
    const SMALLEST_CURVATURE: f64 = 1e-6;

    /// What damping adds to a curvature.
    #[inline(always)]
    pub(super) fn added(damping: f64, curvature: f64) -> f64 {
        damping * curvature.max(Self::SMALLEST_CURVATURE)
    }

    /// What the pivot of a damped curvature must be above.
    #[inline(always)]
    pub(super) fn smallest(damping: f64, curvature: f64) -> f64 {
        Self::ROUNDING * (curvature + Self::added(damping, curvature))
    }

    /// The square of a gradient, measured by its curvature: zero where nothing is seen, and not finite
    /// where a derivative is not or where its square is lost.
    #[inline(always)]
    pub(super) fn scaled_square(gradient: f64, curvature: f64) -> f64 {
        let is_unseen = gradient == 0.0 && curvature == 0.0;
        if is_unseen { 0.0 } else { gradient * gradient / curvature }
    }

    /// Whether a pivot is so near to what it must be above that the Jacobian has to decide.
    pub(super) fn are_suspicious(smallest: f64, pivot: f64) -> bool {
        pivot < Self::SUSPICIOUS * smallest
    }
}

/// How steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Every step is the minimum of the linearized problem, and is taken.
    GaussNewton,
    /// Steps are damped, and refused when the cost does not fall ([@nielsen1999; @nocedal2006]).
    LevenbergMarquardt {
        /// The first damping, relative to the Hessian's diagonal, of which a sparse system counts no
        /// entry as less than 1e-6; at most 1e12. At zero, steps are
        /// damped once one has been tried.
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
    /// Stop when the scaled gradient is shorter; see [`Prediction::gradient_norm`].
    pub gradient_tolerance: f64,
    /// Stop when the next step would be shorter, measured as [`Prediction::step_norm`].
    pub step_tolerance: f64,
    /// Stop when the predicted decrease of the next step or, with Levenberg-Marquardt, the decrease by
    /// the last one, is less than this part of the cost.
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

    /// For problems of thousands of variables, whose last digits are worth less than their time:
    /// at most fifty steps, until the cost falls by less than a millionth.
    pub fn large_problem() -> Self {
        Self { max_iterations: 50, decrease_tolerance: 1e-6, ..Self::default() }
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
/// Why a solver stopped. The first four are convergence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The gradient is below its tolerance.
    GradientSmall,
    /// The next step would be below its tolerance, and not because of damping.
    StepSmall,
    /// The next step would lower the cost by hardly anything, and not because of damping.
    PredictedDecreaseSmall,
    /// The last step lowered the cost by hardly anything, and not because of damping.
    DecreaseSmall,
    /// The number of iterations was used up.
    IterationLimit,
    /// No damping, however large, gives a step that lowers the cost, and the gradient is not zero.
    Stalled,
    /// The same with a linearization point that is frozen: along that Jacobian nothing descends.
    NoDescentAtFrozenPoint,
    /// A Gauss-Newton step led to where a residual or its derivative is undefined or not finite.
    LeftDomain,
}
// ANCHOR_END: stop

impl Stop {
    /// Whether the values are a stationary point, to the tolerances.
    pub fn is_convergence(&self) -> bool {
        use Stop::{DecreaseSmall, GradientSmall, PredictedDecreaseSmall, StepSmall};
        matches!(self, GradientSmall | StepSmall | PredictedDecreaseSmall | DecreaseSmall)
    }

    /// Whether steps led as far as they could, be it to no stationary point: they were not used up,
    /// and did not lead to where a residual or its derivative is undefined.
    pub fn is_settled(&self) -> bool {
        !matches!(self, Stop::IterationLimit | Stop::LeftDomain)
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            Self::GradientSmall => "converged: the gradient is below its tolerance",
            Self::StepSmall => "converged: the next step would be below its tolerance",
            Self::PredictedDecreaseSmall => {
                "converged: the next step would lower the cost by hardly anything"
            }
            Self::DecreaseSmall => "converged: the last step lowered the cost by hardly anything",
            Self::IterationLimit => "not converged: the iterations are used up",
            Self::Stalled => {
                "not converged: no step lowers the cost although the gradient is not zero; check \
                 the Jacobians"
            }
            Self::NoDescentAtFrozenPoint => {
                "not converged: no step along the frozen Jacobian lowers the cost; let the \
                 linearization point follow, or accept the values"
            }
            Self::LeftDomain => {
                "not converged: the last step led to where a residual or its derivative is undefined \
                 or not finite; start nearer or use Levenberg-Marquardt"
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
    /// The norm of the scaled gradient at the last linearization: at the end, unless
    /// [`Search::without_end`] was asked for.
    pub gradient_norm: f64,
    /// Why it stopped.
    pub stop: Stop,
}

/// Values of all variables, and how they were found.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The best values found; for Gauss-Newton, the last.
    pub values: Values,
    /// How they were found.
    pub report: Report,
}

impl Solution {
    /// The same, if steps led as far as they could ([`Stop::is_settled`]).
    ///
    /// # Errors
    ///
    /// [`SolveError::NotConverged`] when they were used up, or led to where a residual is undefined.
    pub fn settled(self) -> Result<Self, SolveError> {
        let stop = self.report.stop;
        stop.is_settled().then_some(self).ok_or(SolveError::NotConverged { stop })
    }
}

/// Above this damping, relative to the Hessian's diagonal, the search for a step is given up.
pub(crate) const LARGEST_DAMPING: f64 = 1e12;
/// Below it, damping is lost in rounding.
const SMALLEST_DAMPING: f64 = 1e-12;
/// A refused step is followed by one with at least this damping.
const SMALLEST_RAISED_DAMPING: f64 = 1e-9;
/// A step is taken when the cost falls by at least this part of what was predicted.
const SMALLEST_GAIN: f64 = 1e-4;
/// Under stronger damping every step is small, which says nothing about the minimum.
const STRONG_DAMPING: f64 = 1.0;

// ANCHOR: damping
/// How strongly steps are damped, and how that changes.
#[derive(Debug, Clone)]
struct Damping {
    value: f64,
    /// By which the next refused step raises it.
    growth: f64,
}

impl Damping {
    /// After a step that was taken, less of it where the gain is above one half, more where it is
    /// below. After one that was refused, more, and faster every time.
    fn learn(&mut self, gain: Option<f64>) {
        if let Some(gain) = gain {
            let factor = (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            self.value = (self.value * factor).max(SMALLEST_DAMPING);
            self.growth = 2.0;
        } else {
            self.value = (self.value * self.growth).max(SMALLEST_RAISED_DAMPING);
            self.growth *= 2.0;
        }
    }
}
// ANCHOR_END: damping

impl Damping {
    fn begin(options: &Options) -> Self {
        let value = match options.method {
            Method::GaussNewton => 0.0,
            Method::LevenbergMarquardt { initial_damping } => initial_damping,
        };
        Self { value, growth: 2.0 }
    }
}

impl Problem {
    /// Minimizes the cost, beginning at the problem's values, which stay as they are.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when an option is impossible, when there is nothing to solve, when a residual is
    /// undefined or not finite at the beginning, or when a Gauss-Newton step is not determined. What goes
    /// wrong later ends the search and is told by [`Report::stop`].
    pub fn solve(&self, options: &Options) -> Result<Solution, SolveError> {
        self.solve_with(Dense::new(self)?, options)
    }

    /// The same with another linear system than the dense one.
    ///
    /// # Errors
    ///
    /// As those of [`Problem::solve`].
    pub fn solve_with(
        &self,
        system: impl LinearSystem,
        options: &Options,
    ) -> Result<Solution, SolveError> {
        let mut search = Search::new(self, system, options)?;
        let stop = loop {
            if let Some(stop) = search.iterate(self)? {
                break stop;
            }
        };
        Ok(search.finish(stop))
    }
}

// ANCHOR: search
/// A search that goes step by step: where it is, and where it might go.
#[derive(Debug, Clone)]
pub struct Search<S> {
    system: S,
    options: Options,
    values: Values,
    trial: Values,
    /// Where derivatives are taken, when some linearization point is frozen.
    frozen: Option<Values>,
    cost: f64,
    step: Vec<f64>,
    damping: Damping,
    iterations: Vec<Iteration>,
    /// Whether the last step is followed by a linearization.
    linearizes_end: bool,
}
// ANCHOR_END: search

impl<S: LinearSystem> Search<S> {
    /// A search that begins at the values of a problem. All memory is taken here.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when an option is impossible or a residual undefined or not finite.
    pub fn new(problem: &Problem, system: S, options: &Options) -> Result<Self, SolveError> {
        options.check()?;
        let values = problem.values().clone();
        let mut search = Self {
            system,
            options: *options,
            trial: values.clone(),
            frozen: problem.linearization_point(),
            cost: 0.0,
            step: vec![0.0; values.dimension()],
            values,
            damping: Damping::begin(options),
            iterations: Vec::with_capacity(options.max_iterations.min(1000)),
            linearizes_end: true,
        };
        search.begin(problem)?;
        Ok(search)
    }

    /// Begins again at the values of another problem, or of one that has changed, for which the system
    /// has been made ready by then.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when the system cannot be made ready, or when a residual is undefined or not
    /// finite.
    pub fn begin_again(
        &mut self,
        problem: &Problem,
        ready: impl FnOnce(&mut S) -> Result<(), SolveError>,
    ) -> Result<(), SolveError> {
        ready(&mut self.system)?;
        self.values.clone_from(problem.values());
        self.trial.clone_from(problem.values());
        self.frozen = problem.linearization_point();
        self.step.resize(self.values.dimension(), 0.0);
        self.damping = Damping::begin(&self.options);
        self.iterations.clear();
        self.begin(problem)
    }

    /// Linearizes where the search begins.
    fn begin(&mut self, problem: &Problem) -> Result<(), SolveError> {
        let cost = self.linearize(problem)?;
        self.cost = cost.unwrap_or_else(|| problem.cost(&self.values));
        if self.cost.is_finite() { Ok(()) } else { Err(problem.not_finite(self.point())) }
    }

    /// The same search, but nothing is linearized where it ends: the system stays that of the last step,
    /// which is enough for who goes on from there with another problem.
    pub fn without_end(self) -> Self {
        Self { linearizes_end: false, ..self }
    }

    /// Tries one step, and says when to stop.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`] or [`SolveError::LostToRounding`] when a Gauss-Newton step is not
    /// determined, [`SolveError::NullSpace`] when that cannot be said, and those of
    /// [`Problem::linearize`] where a step leads.
    pub fn iterate(&mut self, problem: &Problem) -> Result<Option<Stop>, SolveError> {
        if self.iterations.len() >= self.options.max_iterations {
            return Ok(Some(Stop::IterationLimit));
        }
        match self.options.method {
            Method::GaussNewton => self.gauss_newton(problem),
            Method::LevenbergMarquardt { .. } => self.levenberg_marquardt(problem),
        }
    }

    // ANCHOR: gauss_newton
    /// A step that is taken wherever it leads.
    fn gauss_newton(&mut self, problem: &Problem) -> Result<Option<Stop>, SolveError> {
        let predicted = self.system.step(0.0, &mut self.step);
        let is_clear = |_: &_| !self.system.is_suspicious() || problem.is_determined(self.point());
        let Some(predicted) = predicted.filter(is_clear) else {
            return Err(self.undetermined(problem));
        };
        if let Some(stop) = self.before_trial(&predicted) {
            return Ok(Some(stop));
        }
        let trial_cost = self.try_step(problem);
        self.record(0.0, &predicted, trial_cost);
        let is_taken = match trial_cost {
            Some(cost) => self.take_trial(problem, cost, false)?,
            None => false,
        };
        Ok((!is_taken).then_some(Stop::LeftDomain))
    }
    // ANCHOR_END: gauss_newton

    /// A step that is damped, and taken if it lowers the cost enough. [`Search::iterate`] counts
    /// them; who calls this instead counts them himself.
    ///
    /// # Errors
    ///
    /// A [`SolveError`] when the values that a step was refused for cannot be linearized again.
    // ANCHOR: levenberg_marquardt
    pub fn levenberg_marquardt(&mut self, problem: &Problem) -> Result<Option<Stop>, SolveError> {
        let damping = self.damping.value;
        if damping > LARGEST_DAMPING {
            return Ok(Some(self.stalled()));
        }
        let Some(predicted) = self.system.step(damping, &mut self.step) else {
            self.damping.learn(None);
            return Ok(None);
        };
        if let Some(stop) = self.before_trial(&predicted) {
            return Ok(Some(stop));
        }
        let trial_cost = self.try_step(problem);
        let gain = self.gain_ratio(&predicted, trial_cost).filter(|gain| *gain > SMALLEST_GAIN);
        self.record(damping, &predicted, trial_cost);
        let Some(trial_cost) = trial_cost.filter(|_| gain.is_some()) else {
            self.damping.learn(None);
            return Ok(None);
        };
        let is_level = self.cost - trial_cost <= self.options.decrease_tolerance * self.cost
            && damping <= STRONG_DAMPING;
        let is_taken = self.take_trial(problem, trial_cost, is_level)?;
        self.damping.learn(gain.filter(|_| is_taken));
        Ok((is_taken && is_level).then_some(Stop::DecreaseSmall))
    }
    // ANCHOR_END: levenberg_marquardt

    // ANCHOR: stopping
    /// Whether this step is worth trying. Under strong damping every step is small, which says
    /// nothing about the minimum.
    fn before_trial(&self, predicted: &Prediction) -> Option<Stop> {
        let options = &self.options;
        if predicted.gradient_norm <= options.gradient_tolerance {
            return Some(Stop::GradientSmall);
        }
        if self.damping.value > STRONG_DAMPING {
            return None;
        }
        if predicted.step_norm <= options.step_tolerance {
            Some(Stop::StepSmall)
        } else if predicted.predicted_decrease <= options.decrease_tolerance * self.cost {
            Some(Stop::PredictedDecreaseSmall)
        } else {
            None
        }
    }
    // ANCHOR_END: stopping

    /// No damping helps.
    fn stalled(&self) -> Stop {
        if self.frozen.is_some() { Stop::NoDescentAtFrozenPoint } else { Stop::Stalled }
    }

    /// The point at which factors are evaluated.
    fn point(&self) -> Point<'_> {
        Point { values: &self.values, frozen: self.frozen.as_ref() }
    }

    fn linearize(&mut self, problem: &Problem) -> Result<Option<f64>, SolveError> {
        if let Some(frozen) = &mut self.frozen {
            problem.follow(&self.values, frozen);
        }
        let at = Point { values: &self.values, frozen: self.frozen.as_ref() };
        self.system.linearize(problem, at)
    }

    // ANCHOR: try_step
    /// Moves every variable by its part of the step, and gives the cost there, or `None` where a
    /// residual has none.
    fn try_step(&mut self, problem: &Problem) -> Option<f64> {
        self.values.retract_into(&self.step, &mut self.trial);
        let cost = problem.cost(&self.trial);
        cost.is_finite().then_some(cost)
    }

    /// Goes to the end of the step, unless derivatives have no values there. True when it did.
    fn take_trial(
        &mut self,
        problem: &Problem,
        cost: f64,
        is_level: bool,
    ) -> Result<bool, SolveError> {
        swap(&mut self.values, &mut self.trial);
        let is_last = is_level || self.iterations.len() >= self.options.max_iterations;
        if (self.linearizes_end || !is_last) && self.linearize(problem).is_err() {
            swap(&mut self.values, &mut self.trial);
            self.linearize(problem)?;
            return Ok(false);
        }
        self.cost = cost;
        if let Some(last) = self.iterations.last_mut() {
            last.accepted = true;
        }
        Ok(true)
    }
    // ANCHOR_END: try_step

    fn gain_ratio(&self, predicted: &Prediction, trial_cost: Option<f64>) -> Option<f64> {
        Some((self.cost - trial_cost?) / predicted.predicted_decrease)
    }

    /// Notes a step that has been tried and not yet taken.
    fn record(&mut self, damping: f64, predicted: &Prediction, trial_cost: Option<f64>) {
        self.iterations.push(Iteration {
            cost: self.cost,
            gradient_norm: predicted.gradient_norm,
            damping,
            step_norm: predicted.step_norm,
            trial_cost,
            gain_ratio: self.gain_ratio(predicted, trial_cost),
            accepted: false,
        });
    }

    /// What keeps a Gauss-Newton step from being determined.
    fn undetermined(&self, problem: &Problem) -> SolveError {
        match problem.null_space_at(self.point()) {
            Ok(null_space) => null_space.undetermined(),
            Err(error) => error,
        }
    }

    /// The linear system.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The linear system, to be asked for what it has to compute.
    pub fn system_mut(&mut self) -> &mut S {
        &mut self.system
    }

    /// Where the search stands.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// The cost there.
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// The steps so far.
    pub fn iterations(&self) -> &[Iteration] {
        &self.iterations
    }

    /// The memory that the search holds beside that of its system and its values, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Iteration>() * self.iterations.capacity() + size_of_val(self.step.as_slice())
    }

    /// What has come of the search.
    pub fn finish(self, stop: Stop) -> Solution {
        let gradient_norm = self.system.gradient_norm();
        let Self { values, iterations, cost, .. } = self;
        Solution { values, report: Report { iterations, cost, gradient_norm, stop } }
    }
}

impl Options {
    fn check(&self) -> Result<(), SolveError> {
        let damping = Damping::begin(self).value;
        let numbers = [
            ("initial_damping", damping, (0.0..=LARGEST_DAMPING).contains(&damping)),
            ("gradient_tolerance", self.gradient_tolerance, self.gradient_tolerance >= 0.0),
            ("step_tolerance", self.step_tolerance, self.step_tolerance >= 0.0),
            ("decrease_tolerance", self.decrease_tolerance, self.decrease_tolerance >= 0.0),
        ];
        match numbers.into_iter().find(|(_, value, fits)| !(*fits && value.is_finite())) {
            Some((name, value, _)) => Err(SolveError::Option { name, value }),
            None => Ok(()),
        }
    }
}

/// Why a problem cannot be solved, or not from here.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SolveError {
    /// There is nothing to minimize.
    #[error("the problem has no factors; add at least one")]
    NoFactors,
    /// There is nothing to move.
    #[error("the problem has no free variable; add one or leave one that is not held")]
    NothingFree,
    /// Values belong to another problem.
    #[error(
        "{given} values do not fit the problem's {expected} variables; take those of a solution \
         of this problem, or change a copy of its own"
    )]
    WrongValues {
        /// How many were given.
        given: usize,
        /// How many variables there are.
        expected: usize,
    },
    /// A residual has no value where the search begins.
    #[error("factor {factor} is undefined at these values; begin elsewhere or remove it")]
    Undefined {
        /// The factor's number.
        factor: usize,
    },
    /// A residual or its Jacobian is NaN or infinite.
    #[error(
        "factor {factor} or its Jacobian is not finite at these values; look for a NaN in its \
         measurement or a division by zero"
    )]
    NotFinite {
        /// The factor's number.
        factor: usize,
    },
    /// The squares of finite residuals or derivatives are infinite, or zero.
    #[error(
        "a sum of squares is too large or too small for a number; whiten the residuals and choose \
         units in which the variables are neither huge nor tiny"
    )]
    OutOfRange,
    /// The step is not determined.
    #[error(transparent)]
    Singular(#[from] SingularSystem),
    /// The search has ended elsewhere than at a minimum.
    #[error("{stop}; begin nearer to the minimum, or leave out what contradicts the rest")]
    NotConverged {
        /// Why it ended.
        stop: Stop,
    },
    /// It cannot be said whether the step is determined.
    #[error(transparent)]
    NullSpace(#[from] NullSpaceError),
    /// The Jacobian has full rank, but the normal equations, which hold its square, do not keep it.
    #[error(
        "the weakest singular value of the scaled Jacobian is \
         {least_seen:.1e} of the largest and its square is lost to rounding in the normal \
         equations; for a step use Levenberg-Marquardt, for a covariance the dense system, or measure the \
         weakest direction better"
    )]
    LostToRounding {
        /// The smallest singular value, as a fraction of the largest.
        least_seen: f64,
    },
    /// The structure of the problem is not one that the linear system can use.
    #[error("factor {factor} {what}")]
    Structure {
        /// The factor's number.
        factor: usize,
        /// What does not fit.
        what: &'static str,
    },
    /// A variable does not fit into the blocks of the linear system.
    #[error(
        "variable {variable} has {found} coordinates, those before it in its row counted, or is a landmark \
         of which not three, or not all, move; the landmark elimination wants blocks of {dimension}, and \
         landmarks of three: choose sizes that fit, or solve with fronts"
    )]
    Block {
        /// The variable's number.
        variable: usize,
        /// Its dimension, and that of those which stand before it in its row of blocks.
        found: usize,
        /// The size of a block.
        dimension: usize,
    },
    /// Somebody names a variable that does not exist.
    #[error("there is no variable {variable} in the problem; name one that has been added")]
    NoSuchVariable {
        /// The variable's number.
        variable: usize,
    },
    /// A landmark takes the steps of another one, which the elimination of one at a time cannot do.
    #[error(
        "landmark {variable} is tied to another one; the landmark elimination moves each by itself: \
         make them one variable, or solve with the dense system"
    )]
    TiedLandmark {
        /// The variable's number.
        variable: usize,
    },
    /// An option has an impossible value.
    #[error(
        "option {name} is {value}; tolerances and damping are finite and not negative, and damping \
         begins with at most 1e12"
    )]
    Option {
        /// Its name.
        name: &'static str,
        /// The value given.
        value: f64,
    },
}
