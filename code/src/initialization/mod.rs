//! From nothing to a converged estimate of a flight.
//!
//! [`at_rest`] begins while the body stands, and says how well it knows which way is up. A
//! [`Batch`] is all states, biases and landmarks of a flight at once.

mod batch;
mod error;
mod rest;
mod sensors;

pub use batch::{Batch, Sighting};
pub use error::BatchError;
pub use rest::{NotAtRest, RestOptions, at_rest};
pub use sensors::Sensors;
