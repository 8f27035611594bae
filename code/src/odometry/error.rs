//! What an odometry does not take.

use thiserror::Error;

use crate::msckf::MsckfError;
use crate::smoother::SmootherError;

/// What an odometry does not take. It then stays as it was.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OdometryError {
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
        /// Its time, on the camera's clock.
        nanoseconds: i64,
        /// That of the last picture, or of a start that was told.
        last: i64,
    },
    /// The first reading is later than the start that was told.
    #[error(
        "the first reading, at {nanoseconds} ns, is later than the start at {start} ns; give earlier ones"
    )]
    FirstReading {
        /// Its time.
        nanoseconds: i64,
        /// That of the start.
        start: i64,
    },
    /// A feature has a number that is not finite, or its track does not come after that before it.
    #[error(
        "track {track} of the picture at {nanoseconds} ns is not finite, not in order or there twice; \
         leave it out"
    )]
    Feature {
        /// The track.
        track: usize,
        /// The time of the picture, on the camera's clock.
        nanoseconds: i64,
    },
    /// The readings have not come as far as the picture.
    #[error(
        "the picture at {nanoseconds} ns of the sensor's clock is later than all readings; give it \
         again behind the first reading that is as late"
    )]
    EarlyPicture {
        /// Its time, on the sensor's clock.
        nanoseconds: i64,
    },
    /// The filter cannot be made of a start, or, inside [`Lost::Estimator`](super::Lost::Estimator), could
    /// not go on.
    #[error(transparent)]
    Msckf(#[from] MsckfError),
    /// The smoother cannot be made of a start, or, inside [`Lost::Estimator`](super::Lost::Estimator),
    /// could not go on.
    #[error(transparent)]
    Smoother(#[from] SmootherError),
}
