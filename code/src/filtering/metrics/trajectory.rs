//! How far an estimated trajectory is from the true one.

use thiserror::Error;

use super::alignment::{align_one, check, moved};
use super::{AlignmentError, Freedom, RootMeanSquares, StateError, aligned};
use crate::inertial::NavState;

// ANCHOR: absolute
/// The absolute trajectory error: roots of the mean squares of what is left between the aligned
/// estimate and the truth. The states belong together by their places.
///
/// Which errors, and the alignment, are those of @zhang2018, with one exception. There a position is
/// turned by its rotation's error before it is subtracted, which makes the error of the position
/// depend on how far away the origin of the world is. Here, and in the program of its authors, it
/// is the distance between the two positions.
///
/// # Errors
///
/// [`AlignmentError`] when the two cannot be aligned.
pub fn absolute_trajectory_error(
    estimate: &[NavState],
    truth: &[NavState],
    freedom: Freedom,
) -> Result<RootMeanSquares, AlignmentError> {
    let aligned = aligned(estimate, truth, freedom)?;
    let pairs = aligned.iter().zip(truth);
    let errors: Vec<_> = pairs.map(|(state, truth)| StateError::between(state, truth)).collect();
    RootMeanSquares::of(&errors).ok_or(AlignmentError::TooFew { states: 0 })
}
// ANCHOR_END: absolute

// ANCHOR: relative
/// The relative pose error [@zhang2018]: for each pair of a first and a last state, as
/// [`pairs_by_distance`] has them, the error of the last one when the estimate is aligned by the first
/// one alone. What went wrong before the first one does not count.
///
/// # Errors
///
/// [`TrajectoryError`] tells what is missing.
pub fn relative_pose_errors(
    estimate: &[NavState],
    truth: &[NavState],
    pairs: &[(usize, usize)],
    freedom: Freedom,
) -> Result<Vec<StateError>, TrajectoryError> {
    check(estimate, truth)?;
    let states = truth.len();
    let error = |&(first, last): &(usize, usize)| {
        if first.max(last) >= states {
            return Err(TrajectoryError::NoSuchState { state: first.max(last), states });
        }
        let alignment = align_one(&estimate[first], &truth[first], freedom);
        let alignment = alignment.ok_or(TrajectoryError::UpsideDown { state: first })?;
        Ok(StateError::between(&moved(&alignment, &estimate[last]), &truth[last]))
    };
    pairs.iter().map(error).collect()
}
// ANCHOR_END: relative

// ANCHOR: by_distance
/// For every state the first one that the body reaches after so many metres of its path. Those too
/// near the end have none. The path is the truth's, so that it does not depend on the estimate.
///
/// # Errors
///
/// [`TrajectoryError`] when the length is not positive, or longer than the whole path, and for a position
/// that is not finite.
pub fn pairs_by_distance(
    truth: &[NavState],
    metres: f64,
) -> Result<Vec<(usize, usize)>, TrajectoryError> {
    if let Some(state) = truth.iter().position(|state| !state.position.sum().is_finite()) {
        return Err(AlignmentError::NotFinite { state }.into());
    }
    let mut path = 0.0;
    let steps = truth.windows(2).map(|pair| (pair[1].position - pair[0].position).norm());
    let paths = [0.0].into_iter().chain(steps).map(|step| {
        path += step;
        path
    });
    pairs(&paths.collect::<Vec<f64>>(), metres)
}
// ANCHOR_END: by_distance

/// For every state the first one at least so many seconds later. Those too near the end have none.
///
/// # Errors
///
/// [`TrajectoryError`] when the times, in seconds, do not ascend, and when the interval is not
/// positive, or longer than all of them.
pub fn pairs_by_time(times: &[f64], seconds: f64) -> Result<Vec<(usize, usize)>, TrajectoryError> {
    let is_later = |state: usize| state == 0 || times[state - 1] < times[state];
    match (0..times.len()).find(|state| !(times[*state].is_finite() && is_later(*state))) {
        Some(state) => Err(TrajectoryError::Order { state }),
        None => pairs(times, seconds),
    }
}

// ANCHOR: pairs
/// For every place the first one at which this much has been gained, of what does not descend.
fn pairs(gained: &[f64], interval: f64) -> Result<Vec<(usize, usize)>, TrajectoryError> {
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(TrajectoryError::Interval { interval });
    }
    // Sums of steps are round where an interval of so many steps is meant.
    let largest = gained.iter().fold(0.0, |largest: f64, at| largest.max(at.abs()));
    let enough = interval * (1.0 - 1e-9) - 4.0 * f64::EPSILON * largest;
    let enough = enough.max(f64::MIN_POSITIVE);
    let last = |&start: &f64| gained.partition_point(|at| at - start < enough);
    let pairs = gained.iter().map(last).enumerate().take_while(|(_, last)| *last < gained.len());
    let pairs: Vec<_> = pairs.collect();
    let whole = gained.last().zip(gained.first()).map_or(0.0, |(last, first)| last - first);
    if pairs.is_empty() { Err(TrajectoryError::TooShort { whole, interval }) } else { Ok(pairs) }
}
// ANCHOR_END: pairs

/// Why there is no relative error.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TrajectoryError {
    /// The trajectories do not belong together, are too short, or have a number that is not finite.
    #[error(transparent)]
    Alignment(#[from] AlignmentError),
    /// The interval is not one.
    #[error("{interval} is no length of a stretch; give metres or seconds above zero")]
    Interval {
        /// What was given.
        interval: f64,
    },
    /// No stretch is as long.
    #[error(
        "the whole is {whole} long and no stretch of it {interval}; ask for a shorter one, in \
         metres or seconds as the whole"
    )]
    TooShort {
        /// From first to last.
        whole: f64,
        /// What was asked for.
        interval: f64,
    },
    /// The times do not ascend.
    #[error(
        "state {state} is not later than the one before it, or at no time; sort the states by time"
    )]
    Order {
        /// Counted from zero.
        state: usize,
    },
    /// A pair names a state that is not there.
    #[error(
        "a pair names state {state}, counted from zero, of {states}; take pairs of this flight"
    )]
    NoSuchState {
        /// The one that is named.
        state: usize,
        /// How many there are.
        states: usize,
    },
    /// No turn about the vertical is better than another.
    #[error(
        "state {state} is estimated upside down, so no yaw brings it near the truth; align in six \
         degrees of freedom, or count it as a failure"
    )]
    UpsideDown {
        /// Counted from zero.
        state: usize,
    },
}
