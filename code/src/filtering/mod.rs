//! Filters: what is believed of a few variables, carried on by readings and corrected by
//! measurements one after the other.
//!
//! A [`Belief`] has an estimate of each variable and one covariance of all their errors. The error
//! of a variable is the step that leads from its estimate to the truth,
//! [`Manifold::local`](crate::least_squares::Manifold::local), in the order of the variables. A
//! [`Transition`] carries a state and its biases over an interval of readings, by the derivatives
//! of the same residual that a smoother has for it. [`correct`] is the update of a linear
//! measurement, [`correct_root`] that of a root, and [`Belief::update`] that of any factors,
//! iterated where they bend.
//!
//! Two questions are asked of an estimator whose truth is known, and they are not the same. *Is it
//! consistent*: are its errors as large as its covariances say? [`nees`] and [`nis`] divide an
//! error by its covariance, and [`NeesBand`] says between which values their mean over many runs
//! has to lie. *Is it accurate*: how far is its trajectory from the true one, after the world that
//! the sensors cannot see has been chosen by [`align`]? [`absolute_trajectory_error`] and
//! [`relative_pose_errors`] answer that.
//!
//! The world's z axis is vertical, as [`GRAVITY`](crate::inertial::GRAVITY) has it.

mod belief;
mod chi_square;
mod correction;
pub(crate) mod metrics;
mod transition;
mod update;

pub use belief::{Belief, BeliefError};
pub use chi_square::{
    ChiSquareError, chi_square_above, chi_square_band, chi_square_below, chi_square_quantile,
};
pub use correction::{
    Correction, CorrectionError, Form, carry_root, correct, correct_root, innovation_squared,
};
pub use metrics::{
    AlignmentError, BandError, BlockNees, Freedom, NeesBand, NeesError, RootMeanSquares,
    StateError, TrajectoryError, absolute_trajectory_error, align, aligned, attitude_in_world,
    nees, nis, pairs_by_distance, pairs_by_time, relative_pose_errors,
};
pub(crate) use metrics::{rotation_towards, yaw_towards};
pub use transition::{Transition, TransitionError};
pub use update::{Update, UpdateError, UpdateOptions};
