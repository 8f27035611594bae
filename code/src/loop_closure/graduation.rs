//! Graduated non-convexity: which loops are right is decided slowly.

use super::switches::positive;
use super::{GraphProblem, LoopClosureError, PoseGraph};
use crate::factors::GraphPose;
use crate::least_squares::{Kernel, Options, Report};

/// How slowly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Graduation {
    /// The error, in standard deviations, up to which a measurement may be right: the root of a
    /// quantile of χ² with as many degrees of freedom as the measurement has.
    pub threshold: f64,
    /// By what the control parameter grows from round to round.
    pub growth: f64,
    /// How many rounds there may be.
    pub max_rounds: usize,
}

impl Graduation {
    /// The usual pace: 1.4 a round, at most a hundred rounds.
    pub fn with_threshold(threshold: f64) -> Self {
        Self { threshold, growth: 1.4, max_rounds: 100 }
    }

    fn check(&self) -> Result<(), LoopClosureError> {
        positive("threshold", self.threshold, 0.0)?;
        positive("growth", self.growth, 1.0)
    }
}

/// Poses that have been estimated, and which loops were believed.
#[derive(Debug, Clone)]
pub struct GraduatedGraph<P> {
    /// The poses.
    pub poses: Vec<P>,
    /// The weight of each loop in the order given: one or zero, once everything is decided.
    pub weights: Vec<f64>,
    /// How many problems were solved.
    pub rounds: usize,
    /// How the last of them was.
    pub report: Report,
}

impl<P: GraphPose<D>, const D: usize> PoseGraph<P, D> {
    /// The poses when each of these measurements either counts as its square or, beyond a threshold,
    /// as a constant: truncated least squares, by the graduated non-convexity of [@yang2020]. The
    /// others always count, and must hold all poses together.
    ///
    /// The surrogate cost of a control parameter μ is convex for μ near zero and the truncated square
    /// for μ without end. Its minimum is that of a weighted problem whose weights follow from the
    /// errors before it.
    ///
    /// # Errors
    ///
    /// As those of [`PoseGraph::solve`], [`LoopClosureError::NoSuchMeasurement`] and
    /// [`LoopClosureError::Option`].
    // ANCHOR: solve_graduated
    pub fn solve_graduated(
        &self,
        loops: &[usize],
        graduation: &Graduation,
        options: &Options,
    ) -> Result<GraduatedGraph<P>, LoopClosureError> {
        graduation.check()?;
        self.check_numbers(loops)?;
        let limit = graduation.threshold.powi(2);
        let mut graph = self.clone();
        let (mut weights, mut rounds) = (vec![1.0; loops.len()], 1);
        let mut report = graph.improve(loops, &weights, options)?;
        let worst = graph.squared_errors(loops).fold(0.0, f64::max);
        let mut control = limit / (2.0 * worst - limit);
        while worst > limit && rounds < graduation.max_rounds {
            let errors = graph.squared_errors(loops);
            weights = errors.map(|error| truncated_weight(error, limit, control)).collect();
            report = graph.improve(loops, &weights, options)?;
            (control, rounds) = (control * graduation.growth, rounds + 1);
            if weights.iter().all(|weight| [0.0, 1.0].contains(weight)) {
                break;
            }
        }
        Ok(GraduatedGraph { poses: graph.poses, weights, rounds, report })
    }
    // ANCHOR_END: solve_graduated

    /// The squared errors of some measurements; infinite where there is none.
    fn squared_errors(&self, numbers: &[usize]) -> impl Iterator<Item = f64> {
        numbers.iter().map(|number| self.squared_error(*number).unwrap_or(f64::INFINITY))
    }

    /// Moves the poses to the minimum with weights for some measurements. Those that weigh nothing are
    /// left out.
    fn improve(
        &mut self,
        loops: &[usize],
        weights: &[f64],
        options: &Options,
    ) -> Result<Report, LoopClosureError> {
        let mut weight_of = vec![1.0; self.measurements.len()];
        loops.iter().zip(weights).for_each(|(number, weight)| weight_of[*number] = *weight);
        let (mut problem, poses) = self.variables()?;
        for (number, weight) in weight_of.into_iter().enumerate().filter(|(_, w)| *w > 0.0) {
            let mut factor = self.factor(number, &poses)?;
            factor.sqrt_information *= weight.sqrt();
            problem.add_factor(factor, Kernel::Squared)?;
        }
        let solved = GraphProblem { problem, poses }.solve(options)?;
        self.poses = solved.poses;
        Ok(solved.report)
    }
}

// ANCHOR: truncated_weight
/// The weight of a measurement, from its squared error, the squared threshold and the control
/// parameter: one where the surrogate is a square, zero where it is constant, and in between what
/// joins them without a kink. Implements {eq:graduated-weight}.
pub fn truncated_weight(error: f64, limit: f64, control: f64) -> f64 {
    let outer = limit * (control + 1.0) / control;
    let inner = limit * control / (control + 1.0);
    if error >= outer {
        0.0
    } else if error <= inner {
        1.0
    } else {
        (limit * control * (control + 1.0) / error).sqrt() - control
    }
}
// ANCHOR_END: truncated_weight
