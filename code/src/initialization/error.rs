//! What cannot be a batch.

use std::fmt;

use thiserror::Error;

use crate::inertial::WindowError;
use crate::least_squares::{ProblemError, SolveError, WhiteningError};
use crate::preintegration::PreintegrationError;
use crate::structure_from_motion::ReconstructionError;

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
    /// States that are known belong to no pictures.
    #[error(
        "{states} states are known from picture {first} on, of {pictures}; give one or more, and none \
         beyond the last picture"
    )]
    Known {
        /// The picture of the first, counted from zero.
        first: usize,
        /// How many are known.
        states: usize,
        /// How many pictures there are.
        pictures: usize,
    },
    /// A state does not exist.
    #[error("there is no state {state} among {states}, counted from zero")]
    State {
        /// The number given.
        state: usize,
        /// How many there are.
        states: usize,
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

/// Why readings do not align with a motion that is known up to scale.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AlignmentRefused {
    /// The lists of a motion do not belong together.
    #[error(
        "a motion of {pictures} pictures has {times} times, {rotations} rotations and {centres} \
         centres; give one of each for every picture"
    )]
    Lists {
        /// How many pictures it names.
        pictures: usize,
        /// How many times it has.
        times: usize,
        /// How many rotations.
        rotations: usize,
        /// How many centres.
        centres: usize,
    },
    /// A landmark was seen by a camera that does not exist.
    #[error("track {track} names place {place} of {pictures}, counted from zero; leave it out")]
    Sighting {
        /// The track.
        track: usize,
        /// The place in the lists that it names.
        place: usize,
        /// How many there are.
        pictures: usize,
    },
    /// Too few cameras were found.
    #[error("{found} cameras were found, and five are needed; give more pictures")]
    Cameras {
        /// How many.
        found: usize,
    },
    /// The linear equations have no single solution.
    #[error("scale, velocity and gravity do not follow from the readings; wait for more motion")]
    Undetermined,
    /// The cameras' path cannot be told from one whose scale the readings leave open.
    #[error(
        "all but {beyond:.2e} of the cameras' path could be velocity, gravity and bias, and noise \
         alone may leave {noise:.2e}: its scale is open; wait for more motion"
    )]
    Indistinct {
        /// What they cannot imitate, as a root sum of squares, in the motion's unit.
        beyond: f64,
        /// What noise may leave.
        noise: f64,
    },
    /// Two scales fit equally well.
    #[error(
        "the readings fit a scale of {scale:.3} and one of {other:.3}: the acceleration hardly \
         changed; wait for more motion"
    )]
    TwoScales {
        /// The scale that fits best.
        scale: f64,
        /// The other one.
        other: f64,
    },
    /// The scale came out negative.
    #[error(
        "the scale comes out as {scale:.3}, which is none: the motion is too uniform, or the camera's \
         place on the body is another one; wait for more motion"
    )]
    Scale {
        /// The scale.
        scale: f64,
    },
    /// The readings do not cover the pictures.
    #[error(transparent)]
    Readings(#[from] WindowError),
    /// The readings cannot be summed up.
    #[error(transparent)]
    Preintegration(#[from] PreintegrationError),
    /// A covariance cannot be inverted.
    #[error(transparent)]
    Whitening(#[from] WhiteningError),
    /// A number is none of a problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// There is no solution.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// A motion that leaves the scale free, or nearly so, unless the body turns enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UniformMotion {
    /// The camera went straight on with one velocity.
    ConstantVelocity,
    /// Its acceleration stayed the same.
    ConstantAcceleration,
}

impl NoStart {
    /// The same, with the numbers that chosen pictures have among all.
    pub(super) fn of_pictures(self, chosen: &[usize]) -> Self {
        let among_all = |picture| chosen.get(picture).copied().unwrap_or(picture);
        match self {
            Self::Pictures(ReconstructionError::Keypoint { picture, keypoint }) => {
                let picture = among_all(picture);
                Self::Pictures(ReconstructionError::Keypoint { picture, keypoint })
            }
            Self::Pictures(ReconstructionError::WithItself { at, picture }) => {
                let picture = among_all(picture);
                Self::Pictures(ReconstructionError::WithItself { at, picture })
            }
            other => other,
        }
    }
}

impl fmt::Display for UniformMotion {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            Self::ConstantVelocity => "velocity",
            Self::ConstantAcceleration => "acceleration",
        })
    }
}

/// Why there is no start in motion.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NoStart {
    /// There are too few pictures for any span of them.
    #[error("{pictures} pictures are too few to begin; give {seconds} s of them or more")]
    TooShort {
        /// How many there are.
        pictures: usize,
        /// How many seconds are enough to look at one.
        seconds: f64,
    },
    /// The body did not stand, and no other beginning was to be looked for.
    #[error(
        "the body never stood for {seconds} s, and a start in motion is not looked for; put it down, or use \
         `BeginOptions::default()`"
    )]
    NoStand {
        /// How long it would have had to.
        seconds: f64,
    },
    /// The camera stays on one spot.
    #[error(
        "the camera hovers: {narrow} of {pairs} pairs of pictures have no parallax to speak of, which \
         hides all depths and the scale; wait until it moves"
    )]
    Hover {
        /// Pairs of pictures whose rays meet at too small angles, or that a turn explains.
        narrow: usize,
        /// Pairs that have matches.
        pairs: usize,
    },
    /// The pictures give no motion.
    #[error("the pictures give no motion: {0}")]
    Pictures(#[from] ReconstructionError),
    /// The readings do not align with it.
    #[error("the readings do not align with the pictures: {0}")]
    Alignment(#[from] AlignmentRefused),
    /// There is no batch of both.
    #[error("pictures and readings have no common estimate: {0}")]
    Batch(#[from] BatchError),
    /// The motion is too uniform to show its scale.
    #[error("the camera moved with constant {motion}, which hides its scale: {error}")]
    Uniform {
        /// What stayed the same.
        motion: UniformMotion,
        /// What could not be found therefore.
        error: Box<NoStart>,
    },
    /// Pixels and readings do not fit together where the search ended.
    #[error(
        "pixels and readings are {:.1} times as far off as their noise says: either this is a wrong minimum, and \
         later pictures have a better one, or noise, calibration or clocks are not what they are said to be",
        .misfit.sqrt()
    )]
    Misfit {
        /// Twice the cost by its degrees of freedom.
        misfit: f64,
    },
    /// The estimate is too uncertain.
    #[error(
        "the scale is known within {:.1} %, the tilt within {:.2}°: wait for more motion",
        100.0 * .scale_sigma,
        .tilt_sigma.to_degrees()
    )]
    Uncertain {
        /// The standard deviation of the scale, as a part of it.
        scale_sigma: f64,
        /// That of the tilt, in radians.
        tilt_sigma: f64,
    },
}

impl NoStart {
    /// Whether another motion would have been enough, and not other readings.
    pub(super) fn is_of_motion(&self) -> bool {
        let of_readings = |error: &AlignmentRefused| {
            matches!(error, AlignmentRefused::Readings(_) | AlignmentRefused::Preintegration(_))
        };
        match self {
            Self::Alignment(error) => !of_readings(error),
            Self::Batch(error) => matches!(error, BatchError::Solve(_)),
            Self::Misfit { .. } => false,
            _ => true,
        }
    }
}

impl From<SolveError> for NoStart {
    fn from(error: SolveError) -> Self {
        Self::Batch(error.into())
    }
}
