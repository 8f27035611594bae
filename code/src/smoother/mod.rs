//! Fixed-lag smoothing: the states of the last seconds, again and again, and what earlier ones have said.
//!
//! A [`Smoother`] is given readings and pictures in the order of their times. After each picture its window has
//! taken a step, or as many as [`SmootherOptions`] says, towards its minimum: states, biases and landmarks of the
//! last seconds, by the readings and pixels of these and by one prior, into which everything older was marginalized.
//!
//! A window has fixed memory, once it is full. A picture allocates its factors and landmarks, the sums of its
//! readings, the lists of the order of elimination, a copy of all values for each step, and the rows that are
//! marginalized, and returns as much.
//!
//! A landmark is a point of the world, or a ray and an inverse depth in the picture that showed it first
//! ([`Parametrization`]); a feature that two cameras on one rig see is a landmark at once
//! ([`SmootherOptions::right`]); and a picture that shows hardly anything new may leave as soon as the next
//! one is there ([`Keyframes`]).

mod anchors;
mod error;
mod fixed_lag;
mod forgetting;
mod keyframes;
mod landmarks;
mod options;
mod window;

pub use error::SmootherError;
pub use fixed_lag::{Smoothed, Smoother};
pub use options::{Keyframes, Parametrization, SmootherOptions};
