//! Consistency and accuracy of an estimate whose truth is known.

mod alignment;
mod band;
mod normalized;
mod state_error;
mod trajectory;

pub use alignment::{AlignmentError, Freedom, align, aligned};
pub(crate) use alignment::{rotation_towards, yaw_towards};
pub use band::{BandError, NeesBand};
pub use normalized::{BlockNees, NeesError, nees, nis};
pub use state_error::{RootMeanSquares, StateError, attitude_in_world};
pub use trajectory::{
    TrajectoryError, absolute_trajectory_error, pairs_by_distance, pairs_by_time,
    relative_pose_errors,
};
