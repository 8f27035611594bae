//! What a window of pictures and inertial readings leaves free, direction by direction.
//!
//! A [`Window`] holds states, biases and landmarks, and the pixels and preintegrated readings that
//! tie them together. [`Window::free_directions`] finds in how many directions all of them can
//! move without any whitened residual changing to first order, and names those directions:
//! translations, the yaw about gravity, tilts, scale, the depth of a landmark.
//!
//! A [`Similarity`] moves a whole window by a finite amount. Cameras never notice;
//! an inertial sensor does, unless the motion is of a kind that lets a bias hide it.

mod direction;
mod flight;
mod nullity;
mod similarity;
mod symmetry;
mod window;

use thiserror::Error;

pub use direction::Direction;
pub use nullity::{FreeDirections, Mixture};
pub use similarity::Similarity;
pub use symmetry::{WorldMotion, four_motions, steps_of_state, vertical};
pub use window::{BiasAssumption, UnknownCalibration, Window};

use crate::least_squares::{NullSpaceError, ProblemError, SolveError, WhiteningError};
use crate::preintegration::PreintegrationError;
use crate::reprojection::ReprojFactorError;
use crate::simulation::FlightError;

/// Why nothing can be said about a window.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ObservabilityError {
    /// There is no state or no landmark.
    #[error("the window has {states} states and {landmarks} landmarks; give at least one of each")]
    Empty {
        /// Number of states.
        states: usize,
        /// Number of landmarks.
        landmarks: usize,
    },
    /// There are intervals, and not one between each two consecutive states.
    #[error(
        "{states} states have {intervals} intervals of readings between them; give one interval \
         for each two consecutive states, or none for pictures alone"
    )]
    Intervals {
        /// Number of states.
        states: usize,
        /// Number of intervals.
        intervals: usize,
    },
    /// The number of biases does not fit what is assumed of them.
    #[error(
        "{given} biases were given and {expected} are needed: one when they are constant, one for \
         each state when they walk"
    )]
    Biases {
        /// Number given.
        given: usize,
        /// Number expected.
        expected: usize,
    },
    /// The number of angular velocities is not that of the states.
    #[error("{given} angular velocities were given for {states} states; give one for each")]
    AngularVelocities {
        /// Number given.
        given: usize,
        /// Number of states.
        states: usize,
    },
    /// A state has a number that is not finite.
    #[error("state {state} is not finite; mend it, or leave it out with what was measured there")]
    State {
        /// Index of the state.
        state: usize,
    },
    /// An observation names a state or landmark that is not there.
    #[error(
        "observation {observation} names state {state} and landmark {landmark}, one of which does \
         not exist; remove it or add what it names"
    )]
    NoSuchVariable {
        /// Index of the observation.
        observation: usize,
        /// The state that it names.
        state: usize,
        /// The landmark that it names.
        landmark: usize,
    },
    /// A landmark has no pixel where its observation says it was seen.
    #[error(
        "observation {observation}: landmark {landmark} is not in front of the camera at state \
         {state}; remove the observation or mend the estimate"
    )]
    NotInFront {
        /// Index of the observation.
        observation: usize,
        /// The state that it names.
        state: usize,
        /// The landmark that it names.
        landmark: usize,
    },
    /// A residual or derivative is not finite, or whatever else keeps a problem from being
    /// linearized.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// It cannot be said what is free.
    #[error(transparent)]
    NullSpace(#[from] NullSpaceError),
    /// A variable cannot be held.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// Readings cannot be summed up.
    #[error(transparent)]
    Preintegration(#[from] PreintegrationError),
    /// A flight cannot be flown.
    #[error(transparent)]
    Simulation(#[from] FlightError),
    /// A covariance cannot be inverted.
    #[error(transparent)]
    Whitening(#[from] WhiteningError),
    /// A measurement is none.
    #[error(transparent)]
    Pixel(#[from] ReprojFactorError),
}
