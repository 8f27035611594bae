//! What can be wrong with a pose graph, or with what is asked of it.

use thiserror::Error;

use super::Inapplicable;
use crate::least_squares::{ProblemError, SolveError};
use crate::two_views::StereoError;

/// Why a pose graph cannot be solved.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LoopClosureError {
    /// There is nothing to solve.
    #[error(
        "the graph has {poses} poses and {measurements} measurements; give at least one of each"
    )]
    Empty {
        /// How many poses there are.
        poses: usize,
        /// How many measurements there are.
        measurements: usize,
    },
    /// Poses were given for another graph.
    #[error("{given} poses were given for a graph of {poses}; give one for each")]
    Poses {
        /// How many were given.
        given: usize,
        /// How many the graph has.
        poses: usize,
    },
    /// A measurement names a pose that does not exist.
    #[error(
        "measurement {measurement} names pose {pose} of {poses}, which are counted from zero; add the \
         pose or remove the measurement"
    )]
    NoSuchPose {
        /// The measurement's number.
        measurement: usize,
        /// The pose that it names.
        pose: usize,
        /// How many poses there are.
        poses: usize,
    },
    /// A measurement names one pose twice.
    #[error("measurement {measurement} goes from pose {pose} to itself; remove it")]
    SamePose {
        /// The measurement's number.
        measurement: usize,
        /// The pose.
        pose: usize,
    },
    /// A pose has a number that is not finite.
    #[error("pose {pose} has a number that is not finite; give another one to begin with")]
    PoseNotFinite {
        /// The pose.
        pose: usize,
    },
    /// A measurement has a number that is not finite.
    #[error("measurement {measurement} has a number that is not finite; remove it")]
    NotFinite {
        /// The measurement's number.
        measurement: usize,
    },
    /// A matrix of information is none.
    #[error(
        "the information of measurement {measurement} is not symmetric and positive definite; give \
         every direction a finite variance"
    )]
    Information {
        /// The measurement's number.
        measurement: usize,
    },
    /// No chain of measurements leads to a pose.
    #[error(
        "no chain of measurements leads from pose 0 to pose {pose}; measure it, or leave it out and \
         solve the parts apart"
    )]
    Unreached {
        /// The first such pose.
        pose: usize,
    },
    /// Somebody names a measurement that does not exist.
    #[error("there is no measurement {measurement} among {measurements}; they count from zero")]
    NoSuchMeasurement {
        /// The number given.
        measurement: usize,
        /// How many there are.
        measurements: usize,
    },
    /// An option has an impossible value.
    #[error("option {name} is {value}; it must be finite and above {above}")]
    Option {
        /// Its name.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What it must be above.
        above: f64,
    },
    /// The rotation of a pose is not decided by the linear problem.
    #[error(
        "the rotation of pose {pose} is not decided once orthogonality is left out; begin from \
         chained measurements instead"
    )]
    Undecided {
        /// The pose.
        pose: usize,
    },
    /// Nothing says how two keyframes stand to each other in all directions.
    #[error(
        "keyframe {second} as seen from keyframe {first} has no covariance that can be inverted; take \
         keyframes that the belief has, or that see more of the same landmarks"
    )]
    Unsure {
        /// The number of the pose that is seen from.
        first: usize,
        /// The number of the pose that is seen.
        second: usize,
    },
    /// A stereo camera cannot have seen this.
    #[error(transparent)]
    Stereo(#[from] StereoError),
    /// A measurement's noise is not alike in all directions.
    #[error(transparent)]
    Inapplicable(#[from] Inapplicable),
    /// A problem cannot be built.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A problem cannot be solved.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
