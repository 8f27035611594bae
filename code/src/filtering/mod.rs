//! Filtering, and how an estimate is judged whose truth is known.
//!
//! Two questions are asked of an estimator, and they are not the same. *Is it consistent*: are its
//! errors as large as its covariances say? [`nees`] and [`nis`] divide an error by its covariance,
//! and [`NeesBand`] says between which values their mean over many runs has to lie. *Is it
//! accurate*: how far is its trajectory from the true one, after the world that the sensors cannot
//! see has been chosen by [`align`]? [`absolute_trajectory_error`] and [`relative_pose_errors`]
//! answer that.
//!
//! The world's z axis is vertical, as [`GRAVITY`](crate::inertial::GRAVITY) has it.

mod chi_square;
mod metrics;

pub use chi_square::{ChiSquareError, chi_square_band, chi_square_below, chi_square_quantile};
pub use metrics::{
    AlignmentError, BandError, BlockNees, Freedom, NeesBand, NeesError, RootMeanSquares,
    StateError, TrajectoryError, absolute_trajectory_error, align, aligned, nees, nis,
    pairs_by_distance, pairs_by_time, relative_pose_errors,
};
