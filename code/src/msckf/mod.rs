//! The multi-state constraint Kalman filter [@mourikis2007]: poses of the last pictures in the state,
//! landmarks outside of it.
//!
//! A track says something of the poses that saw it and of its landmark. [`LinearizedTrack`] has
//! both, and [`LinearizedTrack::project`] turns its rows until three of them name the landmark and
//! all others the poses alone; these correct the filter. By {thm:projection} nothing is lost, as long
//! as the pixels show where the landmark is. [`Msckf`] is the filter itself.

mod error;
mod filter;
mod flight;
mod landmark;
mod options;
mod rest;
mod rows;
mod track;
mod update;
mod window;

pub use error::MsckfError;
pub use filter::{Msckf, Start};
pub use landmark::{LandmarkError, landmark};
pub use options::{MsckfOptions, Rest, WindowPolicy};
pub use rows::Rows;
pub use track::{LinearizedTrack, Sight, TrackError};
pub use window::{PictureReport, Refusals};
