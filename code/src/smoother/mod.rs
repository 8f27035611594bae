//! Fixed-lag smoothing: the states of the last seconds, again and again, and what earlier ones have said.
//!
//! A [`Smoother`] is given readings and pictures in the order of their times. After each picture its window is
//! at a minimum: states, biases and landmarks of the last seconds, by the readings and pixels of these and by one
//! prior, into which everything older was marginalized.

mod error;
mod fixed_lag;
mod forgetting;
mod options;
mod window;

pub use error::SmootherError;
pub use fixed_lag::{Smoothed, Smoother};
pub use options::SmootherOptions;
