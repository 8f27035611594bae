//! From nothing to a converged estimate of a flight.
//!
//! [`at_rest`] begins while the body stands, and says how well it knows which way is up.
//! [`in_motion`] begins while it flies: a [`VisualMotion`] up to scale, what readings say of it
//! linearly in an [`Alignment`], the most likely [`InertialMap`], and from there the [`Batch`] of all
//! states, biases and landmarks at once. [`begin`] chooses between the two, and [`Whole`] is the batch of a
//! flight that has begun.

mod alignment;
mod batch;
mod begin;
mod error;
mod inertial_map;
mod linear;
mod motion;
mod rest;
mod sensors;
mod sphere;
mod uniform;
mod visual;
mod whole;

pub use alignment::{Alignment, align_motion};
pub(crate) use batch::calibrate;
pub use batch::{Batch, Sighting};
pub use begin::{BeginOptions, Beginning, InMotion, StartSearch, begin};
pub use error::{AlignmentRefused, BatchError, NoStart, UniformMotion};
pub use inertial_map::{InertialMap, inertial_map};
pub use linear::LinearAlignment;
pub use motion::{MotionOptions, Started, in_motion};
pub use rest::{NotAtRest, RestOptions, at_rest};
pub use sensors::Sensors;
pub use sphere::{SphereMinimum, minima_on_sphere};
pub use visual::{VisualLandmark, VisualMotion};
pub use whole::{Known, LandmarkRefused, Whole, WholeOptions};
