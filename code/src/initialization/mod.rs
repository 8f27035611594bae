//! From nothing to a converged estimate of a flight.
//!
//! [`at_rest`] begins while the body stands, and says how well it knows which way is up.
//! [`in_motion`] begins while it flies: a [`VisualMotion`] up to scale, what readings say of it
//! linearly in an [`Alignment`], the most likely [`InertialMap`], and from there the [`Batch`] of all
//! states, biases and landmarks at once.

mod alignment;
mod batch;
mod error;
mod inertial_map;
mod motion;
mod rest;
mod sensors;
mod uniform;
mod visual;

pub use alignment::{Alignment, align_motion};
pub use batch::{Batch, Sighting};
pub use error::{AlignmentRefused, BatchError, NoStart, UniformMotion};
pub use inertial_map::{InertialMap, inertial_map};
pub use motion::{MotionOptions, Started, in_motion};
pub use rest::{NotAtRest, RestOptions, at_rest};
pub use sensors::Sensors;
pub use visual::{VisualLandmark, VisualMotion};
