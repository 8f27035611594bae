//! The assembled system: readings and the tracks of pictures go in, and where the body is comes out.
//!
//! An [`Odometry`] looks for a beginning, at rest or in motion, hands it to the estimator that was asked for, and
//! follows. When what it sees contradicts what it believes for too long, or when readings are missing, it says that
//! it is lost, forgets, and looks for a beginning again.

mod engine;
mod error;
mod flight;
mod options;
mod waiting;

pub use error::OdometryError;
pub use flight::{Estimate, Lost, Odometry, Progress};
pub use options::{Estimator, NoSuchEstimator, OdometryOptions};
