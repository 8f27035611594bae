//! What cannot be a batch.

use thiserror::Error;

use crate::inertial::WindowError;
use crate::least_squares::{ProblemError, SolveError, WhiteningError};
use crate::preintegration::PreintegrationError;

/// Why there is no batch.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BatchError {
    /// Too few states, or not one guess for each.
    #[error("{states} times and {guesses} guesses; give two times or more, and a guess for each")]
    States {
        /// How many times there are.
        states: usize,
        /// How many guesses.
        guesses: usize,
    },
    /// A landmark was seen from a state that does not exist.
    #[error("track {track} names state {state} of {states}, counted from zero; leave it out")]
    Sighting {
        /// The track.
        track: usize,
        /// The state that it names.
        state: usize,
        /// How many there are.
        states: usize,
    },
    /// The readings do not reach from one state to the next.
    #[error(transparent)]
    Readings(#[from] WindowError),
    /// The readings cannot be summed up.
    #[error(transparent)]
    Preintegration(#[from] PreintegrationError),
    /// The covariance of readings cannot be inverted.
    #[error(transparent)]
    Whitening(#[from] WhiteningError),
    /// A number is none of a problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// There is no solution.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
