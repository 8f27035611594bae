//! Where recorded data come from: readings, feature tracks, matches, ground truth and pose
//! graphs in text files.
//!
//! Text goes in and values come out. Nothing here opens a file, so whoever does adds its name to
//! the error, which says the line, in tables the column, and what is wrong. Times are integers of nanoseconds.

pub mod bal;
pub mod calibration;
pub mod euroc;
pub mod matches;
pub mod pose_graph;
pub mod recording;
mod table;
pub mod tracks;
pub mod written;

pub use table::{Column, TableError, TableFault};
