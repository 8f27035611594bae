//! Poses, and measurements of one from another.

use std::collections::VecDeque;

use nalgebra::{Isometry2, Isometry3, SMatrix};

use super::{LoopClosureError, UprightPose};
use crate::factors::{BetweenPoses, GraphPose};
use crate::least_squares::{
    Fronts, Kernel, Key, Manifold, Method, Options, Problem, Report, Values,
};

// ANCHOR: pose_graph
/// Poses `world_from_body`, and measurements of one from another.
#[derive(Debug, Clone)]
pub struct PoseGraph<P: GraphPose<D>, const D: usize> {
    /// Where they are, or are believed to be.
    pub poses: Vec<P>,
    /// What was measured, with independent errors.
    pub measurements: Vec<RelativeMeasurement<P, D>>,
}

/// One pose as measured from another.
#[derive(Debug, Clone)]
pub struct RelativeMeasurement<P: GraphPose<D>, const D: usize> {
    /// The number of the pose that it was measured from.
    pub first: usize,
    /// The number of the pose that was measured.
    pub second: usize,
    /// What was measured: `first_from_second`.
    pub measured: P::Measured,
    /// The inverse of the covariance of [`GraphPose::error`]: for poses in space and in the plane the
    /// translation stands first, and its axes are those of the second pose.
    pub information: SMatrix<f64, D, D>,
}

/// Poses in space.
pub type SpatialGraph = PoseGraph<Isometry3<f64>, 6>;
/// Poses in the plane.
pub type PlanarGraph = PoseGraph<Isometry2<f64>, 3>;
/// Poses whose roll and pitch are known.
pub type UprightGraph = PoseGraph<UprightPose, 4>;
// ANCHOR_END: pose_graph

// ANCHOR: pose_graph_options
/// Levenberg-Marquardt as pose graphs want it: with a first damping of 1e-8. Almost nothing resists a
/// slow bend of a long chain, and the damping is measured by what resists a pose that moves alone. With
/// more of it a step straightens no bend. It goes on until the cost falls by less than 1e-14 of itself:
/// [`certify`](super::certify) wants a minimum to more digits than its cost shows.
pub fn pose_graph_options() -> Options {
    let method = Method::LevenbergMarquardt { initial_damping: 1e-8 };
    Options { method, decrease_tolerance: 1e-14, ..Options::default() }
}
// ANCHOR_END: pose_graph_options

/// The least-squares problem of a graph.
pub struct GraphProblem<P> {
    /// The problem. Its factors have the numbers of the measurements.
    pub problem: Problem,
    /// The variable of each pose. The first one is held.
    pub poses: Vec<Key<P>>,
}

impl<P: Manifold> GraphProblem<P> {
    /// The poses among values of the problem.
    pub fn poses_of(&self, values: &Values) -> Vec<P> {
        self.poses.iter().map(|key| values[*key].clone()).collect()
    }

    /// The minimum, by the sparse solver.
    pub(super) fn solve(&self, options: &Options) -> Result<SolvedGraph<P>, LoopClosureError> {
        let solution = self.problem.solve_with(Fronts::new(&self.problem)?, options)?;
        Ok(SolvedGraph { poses: self.poses_of(&solution.values), report: solution.report })
    }
}

/// Poses that have been estimated.
#[derive(Debug, Clone)]
pub struct SolvedGraph<P> {
    /// The poses.
    pub poses: Vec<P>,
    /// How they were found.
    pub report: Report,
}

impl<P: GraphPose<D>, const D: usize> PoseGraph<P, D> {
    // ANCHOR: graph_problem
    /// The least-squares problem, in which the first pose is held and measurements have the kernels
    /// that are given by number.
    ///
    /// # Errors
    ///
    /// A [`LoopClosureError`] when the graph is empty or not connected, a pose is not finite, a measurement
    /// is none, or a kernel's parameter is impossible.
    pub fn problem(
        &self,
        kernel: impl Fn(usize) -> Kernel,
    ) -> Result<GraphProblem<P>, LoopClosureError> {
        let (mut problem, keys) = self.variables()?;
        for number in 0..self.measurements.len() {
            problem.add_factor(self.factor(number, &keys)?, kernel(number))?;
        }
        Ok(GraphProblem { problem, poses: keys })
    }
    // ANCHOR_END: graph_problem

    /// A problem with the poses alone, of a graph that is connected. The first one is held.
    pub(super) fn variables(&self) -> Result<(Problem, Vec<Key<P>>), LoopClosureError> {
        self.check()?;
        let mut problem = Problem::new();
        let keys: Vec<Key<P>> =
            self.poses.iter().map(|pose| problem.add_variable(pose.clone())).collect();
        problem.hold(keys[0])?;
        Ok((problem, keys))
    }

    /// What a measurement says of these variables.
    pub(super) fn factor(
        &self,
        number: usize,
        keys: &[Key<P>],
    ) -> Result<BetweenPoses<P, D>, LoopClosureError> {
        let measurement = &self.measurements[number];
        let sqrt_information = root(&measurement.information)
            .ok_or(LoopClosureError::Information { measurement: number })?;
        Ok(BetweenPoses {
            first: keys[measurement.first],
            second: keys[measurement.second],
            measured: measurement.measured.clone(),
            sqrt_information,
        })
    }

    /// The poses for which the cost of all measurements is least, downhill from where they are.
    ///
    /// # Errors
    ///
    /// As those of [`PoseGraph::problem`], and those of the solver.
    pub fn solve(
        &self,
        kernel: impl Fn(usize) -> Kernel,
        options: &Options,
    ) -> Result<SolvedGraph<P>, LoopClosureError> {
        self.problem(kernel)?.solve(options)
    }

    /// The cost of the poses as they are: half the sum of eᵀ Ω e over all measurements.
    ///
    /// # Errors
    ///
    /// As those of [`PoseGraph::problem`].
    pub fn cost(&self) -> Result<f64, LoopClosureError> {
        let GraphProblem { problem, .. } = self.problem(|_| Kernel::Squared)?;
        Ok(problem.cost(problem.values()))
    }

    /// eᵀ Ω e of one measurement, `None` where there is no such error.
    pub fn squared_error(&self, measurement: usize) -> Option<f64> {
        let RelativeMeasurement { first, second, measured, information } =
            self.measurements.get(measurement)?;
        let error = self.poses.get(*first)?.error(self.poses.get(*second)?, measured)?;
        Some(error.dot(&(information * error)))
    }

    /// The measurements whose poses do not follow each other: those of closed loops.
    pub fn loops(&self) -> Vec<usize> {
        let is_loop = |number: &usize| {
            let RelativeMeasurement { first, second, .. } = self.measurements[*number];
            first.abs_diff(second) != 1
        };
        (0..self.measurements.len()).filter(is_loop).collect()
    }

    /// The same graph with other poses.
    pub fn with_poses(&self, poses: Vec<P>) -> Self {
        Self { poses, measurements: self.measurements.clone() }
    }

    // ANCHOR: chained
    /// The poses that follow from the first one when measurements are chained, with as few closed loops
    /// among them as will reach every pose.
    ///
    /// # Errors
    ///
    /// As those of [`PoseGraph::problem`].
    pub fn chained(&self) -> Result<Vec<P>, LoopClosureError> {
        self.check_measurements()?;
        let mut leaving = vec![Vec::new(); self.poses.len()];
        for RelativeMeasurement { first, second, measured, .. } in &self.measurements {
            leaving[*first].push((*second, measured.clone()));
            leaving[*second].push((*first, P::reversed(measured)));
        }
        let mut poses: Vec<Option<P>> = vec![None; self.poses.len()];
        let mut queue = VecDeque::from([(0, self.poses[0].clone())]);
        while let Some((number, pose)) = queue.pop_front() {
            if poses[number].is_some() {
                continue;
            }
            for (other, measured) in leaving[number].iter().filter(|(at, _)| poses[*at].is_none()) {
                let reached = (*other, pose.reach(measured));
                let is_odometry = other.abs_diff(number) == 1;
                if is_odometry { queue.push_front(reached) } else { queue.push_back(reached) }
            }
            poses[number] = Some(pose);
        }
        let reached =
            |(pose, found): (usize, Option<P>)| found.ok_or(LoopClosureError::Unreached { pose });
        poses.into_iter().enumerate().map(reached).collect()
    }
    // ANCHOR_END: chained

    /// Whether everything is there and connected.
    pub(super) fn check(&self) -> Result<(), LoopClosureError> {
        self.check_connected()?;
        Self::check_poses(&self.poses)
    }

    /// The same, whatever the poses are but the first.
    pub(super) fn check_connected(&self) -> Result<(), LoopClosureError> {
        self.chained().map(|_| ())
    }

    /// Whether all of these poses are numbers.
    pub(super) fn check_poses(poses: &[P]) -> Result<(), LoopClosureError> {
        let is_finite = |pose: &P| {
            let mut none = [0.0; D];
            pose.local(pose, &mut none);
            none.iter().all(|number| number.is_finite())
        };
        match poses.iter().position(|pose| !is_finite(pose)) {
            Some(pose) => Err(LoopClosureError::PoseNotFinite { pose }),
            None => Ok(()),
        }
    }

    fn check_measurements(&self) -> Result<(), LoopClosureError> {
        let (poses, measurements) = (self.poses.len(), self.measurements.len());
        if poses == 0 || measurements == 0 {
            return Err(LoopClosureError::Empty { poses, measurements });
        }
        Self::check_poses(&self.poses[..1])?;
        for (measurement, it) in self.measurements.iter().enumerate() {
            if let Some(&pose) = [it.first, it.second].iter().find(|pose| **pose >= poses) {
                return Err(LoopClosureError::NoSuchPose { measurement, pose, poses });
            }
            if it.first == it.second {
                return Err(LoopClosureError::SamePose { measurement, pose: it.first });
            }
            let mut information = it.information.iter();
            if !(P::is_finite(&it.measured) && information.all(|number| number.is_finite())) {
                return Err(LoopClosureError::NotFinite { measurement });
            }
            let asymmetry = (it.information - it.information.transpose()).amax();
            let is_symmetric = asymmetry <= 1e-9 * it.information.amax();
            if !is_symmetric || root(&it.information).is_none() {
                return Err(LoopClosureError::Information { measurement });
            }
        }
        Ok(())
    }

    /// That measurements exist.
    pub(super) fn check_numbers(&self, numbers: &[usize]) -> Result<(), LoopClosureError> {
        let measurements = self.measurements.len();
        match numbers.iter().find(|number| **number >= measurements) {
            Some(&measurement) => {
                Err(LoopClosureError::NoSuchMeasurement { measurement, measurements })
            }
            None => Ok(()),
        }
    }
}

impl SpatialGraph {
    /// The same graph with roll and pitch kept as they are. What a measurement says of these two is left
    /// out: the other four have their part Pᵀ Σ P of its covariance, with P the change of the six by the
    /// four. Implements {eq:upright-information}.
    // ANCHOR: upright
    pub fn upright(&self) -> UprightGraph {
        let upright = |it: &RelativeMeasurement<Isometry3<f64>, 6>| {
            let up = self.poses.get(it.second).map(UprightPose::up_in_body).unwrap_or_default();
            let mut by_four = SMatrix::<f64, 6, 4>::zeros();
            let turned = it.measured.rotation.to_rotation_matrix().transpose();
            by_four.fixed_view_mut::<3, 3>(0, 0).copy_from(turned.matrix());
            by_four.fixed_view_mut::<3, 1>(3, 3).copy_from(&up);
            let part = |covariance| by_four.transpose() * covariance * by_four;
            let covariance = it.information.cholesky().map(|factor| part(factor.inverse()));
            let information =
                covariance.and_then(|covariance| Some(covariance.cholesky()?.inverse()));
            RelativeMeasurement {
                first: it.first,
                second: it.second,
                measured: it.measured,
                information: information.unwrap_or_default(),
            }
        };
        PoseGraph {
            poses: self.poses.iter().map(|pose| UprightPose::new(*pose)).collect(),
            measurements: self.measurements.iter().map(upright).collect(),
        }
    }
    // ANCHOR_END: upright
}

/// The upper triangular matrix W with Wᵀ W = Ω, if there is one.
fn root<const D: usize>(information: &SMatrix<f64, D, D>) -> Option<SMatrix<f64, D, D>> {
    let factor = information.cholesky()?.l();
    factor.iter().all(|number| number.is_finite()).then(|| factor.transpose())
}
