//! Why a filter cannot go on.

use thiserror::Error;

use crate::filtering::{BeliefError, ChiSquareError, CorrectionError, TransitionError};
use crate::inertial::WindowError;
use crate::preintegration::PreintegrationError;

/// Why a filter cannot go on.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MsckfError {
    /// A reading is not later than the one before.
    #[error("the reading at {nanoseconds} ns is not later than that at {last} ns; sort them")]
    Late {
        /// Its time.
        nanoseconds: i64,
        /// That of the last reading.
        last: i64,
    },
    /// A reading has a number that is not finite.
    #[error("the reading at {nanoseconds} ns is not finite; leave it out")]
    Reading {
        /// Its time.
        nanoseconds: i64,
    },
    /// The window holds fewer poses than a track needs, or hardly any.
    #[error(
        "a window of {clones} poses is too short; give it 2 or more, and no fewer than the \
         {least_sights} pictures that a track needs"
    )]
    Window {
        /// How many poses it holds.
        clones: usize,
        /// How many pictures a track needs.
        least_sights: usize,
    },
    /// The standard deviation of a pixel is not positive, or not finite.
    #[error("a pixel's standard deviation is {sigma}; give a positive, finite number of pixels")]
    PixelSigma {
        /// What was given.
        sigma: f64,
    },
    /// The readings do not reach from the estimate to the picture.
    #[error(transparent)]
    Readings(#[from] WindowError),
    /// The readings cannot be summed up.
    #[error(transparent)]
    Preintegration(#[from] PreintegrationError),
    /// The estimate cannot be carried on.
    #[error(transparent)]
    Transition(#[from] TransitionError),
    /// A covariance is none.
    #[error(transparent)]
    Belief(#[from] BeliefError),
    /// The covariance cannot be corrected.
    #[error(transparent)]
    Correction(#[from] CorrectionError),
    /// The start has a number that is not finite.
    #[error("the state, the bias or the covariance of the start is not finite; give another start")]
    Start,
    /// Derivatives are to be taken at the truth, which begins later.
    #[error(
        "derivatives are taken at the truth, which begins with the first picture; begin at its time"
    )]
    StartBeforeTruth,
    /// Derivatives are to be taken at the truth, and it is not known.
    #[error(
        "derivatives at the truth need that of picture {picture}; follow a simulated recording, or \
         choose another policy"
    )]
    NoTruth {
        /// The picture, counted from zero.
        picture: usize,
    },
    /// The gate is no probability.
    #[error(transparent)]
    Gate(#[from] ChiSquareError),
}
