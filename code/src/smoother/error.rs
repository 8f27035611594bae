//! Why a smoother cannot go on.

use thiserror::Error;

use crate::inertial::WindowError;
use crate::least_squares::{ProblemError, SolveError, WhiteningError};
use crate::preintegration::PreintegrationError;

/// Why a smoother cannot go on. It is as it was after a reading that is late or not finite, a late picture
/// and readings that do not reach; after all others, begin another one.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SmootherError {
    /// A reading is not later than the one before.
    #[error("the reading at {nanoseconds} ns is not later than that at {last} ns; sort them")]
    LateReading {
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
    /// A picture is not later than the one before.
    #[error("the picture at {nanoseconds} ns is not later than that at {last} ns; leave it out")]
    LatePicture {
        /// Its time, on the sensor's clock.
        nanoseconds: i64,
        /// That of the last picture.
        last: i64,
    },
    /// The readings do not reach from the last picture to this one.
    #[error(transparent)]
    Readings(#[from] WindowError),
    /// The readings cannot be summed up.
    #[error(transparent)]
    Preintegration(#[from] PreintegrationError),
    /// A covariance cannot be factored.
    #[error(transparent)]
    Whitening(#[from] WhiteningError),
    /// Something does not fit the window.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The window has no minimum.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
