//! A switch for every loop.

use nalgebra::{Matrix1, Vector1};

use super::{LoopClosureError, PoseGraph};
use crate::factors::{GraphPose, Prior, Switched};
use crate::least_squares::{Fronts, Kernel, Key, Options, Problem, Report};

/// Poses that have been estimated, and which loops were believed.
#[derive(Debug, Clone)]
pub struct SwitchedGraph<P> {
    /// The poses.
    pub poses: Vec<P>,
    /// The switch of each loop in the order given: one for a loop that is believed, near zero for one
    /// that is not.
    pub switches: Vec<f64>,
    /// How they were found.
    pub report: Report,
}

impl<P: GraphPose<D>, const D: usize> PoseGraph<P, D> {
    // ANCHOR: solve_switched
    /// The poses when each of these measurements has a switch, which begins at one and is held there
    /// with an information of `information` ([@sunderhauf2012]): a loop whose squared error
    /// grows beyond it has its switch below one half and counts less and less. A quantile of χ² with as
    /// many degrees of freedom as a measurement has is a good choice.
    ///
    /// # Errors
    ///
    /// As those of [`PoseGraph::solve`], [`LoopClosureError::NoSuchMeasurement`] and
    /// [`LoopClosureError::Option`].
    pub fn solve_switched(
        &self,
        loops: &[usize],
        information: f64,
        options: &Options,
    ) -> Result<SwitchedGraph<P>, LoopClosureError> {
        positive("information", information, 0.0)?;
        self.check_numbers(loops)?;
        let SwitchedProblem { problem, poses, switches } =
            self.switched_problem(loops, information.sqrt())?;
        let solution = problem.solve_with(Fronts::new(&problem)?, options)?;
        let switch = |number: &usize| switches[*number].map(|key| solution.values[key].x);
        Ok(SwitchedGraph {
            poses: poses.iter().map(|key| solution.values[*key].clone()).collect(),
            switches: loops.iter().filter_map(switch).collect(),
            report: solution.report,
        })
    }
    // ANCHOR_END: solve_switched

    // ANCHOR: switched_problem
    /// The problem, with the root of the information of a switch.
    fn switched_problem(
        &self,
        loops: &[usize],
        root: f64,
    ) -> Result<SwitchedProblem<P>, LoopClosureError> {
        let (mut problem, poses) = self.variables()?;
        let (anchor, sqrt_information) = (Vector1::new(1.0), Matrix1::new(root));
        let mut switches = vec![None; self.measurements.len()];
        for number in loops {
            switches[*number].get_or_insert_with(|| problem.add_variable(anchor));
        }
        for (number, switch) in switches.iter().enumerate() {
            let measurement = self.factor(number, &poses)?;
            if let Some(switch) = *switch {
                problem.add_factor(Switched { measurement, switch }, Kernel::Squared)?;
                let prior = Prior { variable: switch, anchor, sqrt_information };
                problem.add_factor(prior, Kernel::Squared)?;
            } else {
                problem.add_factor(measurement, Kernel::Squared)?;
            }
        }
        Ok(SwitchedProblem { problem, poses, switches })
    }
    // ANCHOR_END: switched_problem
}

/// A problem, and its variables: poses, and by measurement its switch.
struct SwitchedProblem<P> {
    problem: Problem,
    poses: Vec<Key<P>>,
    switches: Vec<Option<Key<Vector1<f64>>>>,
}

/// That an option is finite and above what it must be above.
pub(super) fn positive(name: &'static str, value: f64, above: f64) -> Result<(), LoopClosureError> {
    let is_possible = value.is_finite() && value > above;
    is_possible.then_some(()).ok_or(LoopClosureError::Option { name, value, above })
}
