//! Where readings, pixels and truth come from when nothing has flown: worlds and flights that are
//! known exactly.
//!
//! A [`Trajectory`] is a motion by formula, and what a perfect sensor reads on it. A [`Flight`] adds
//! the sensors and their faults, and [`Flight::record`] makes the [`FlightRecording`] that they bring
//! home, with the [`Truth`] beside it, all at once or picture by picture with a [`Recorder`]. A [`Scene`] has cameras alone. What is drawn depends on
//! nothing but the seed.

mod flight;
mod landmarks;
pub(crate) mod random;
mod recorder;
mod recording;
mod scenes;
mod tracker;
mod trajectory;

pub use flight::{Flight, FlightError};
pub use landmarks::landmarks_around;
pub use recorder::Recorder;
pub use recording::{FlightRecording, Truth};
pub use scenes::{Scene, at_true_scale};
pub use trajectory::{EulerAngles, Kinematics, ScalarTrajectory, Trajectory};
