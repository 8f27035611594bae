//! Loop closure: pose graphs, their minimum, whether it is the lowest one, and wrong loops.
//!
//! A [`PoseGraph`] has poses and measurements of one pose from another, by odometry or by a place that
//! was seen again. Its poses are those of a body in space, in the plane, or [`UprightPose`]s: position and
//! yaw, which are the four degrees of freedom that cameras and an inertial sensor cannot know, with roll
//! and pitch kept as gravity gives them.
//!
//! - [`RelativeMeasurement::believed`] is what a filter knows of two keyframes, and
//!   [`RelativeMeasurement::from_stereo`] what their pictures say.
//! - [`PoseGraph::solve`] goes downhill from where the poses are, best with [`pose_graph_options`];
//!   [`PoseGraph::chained`] and [`chordal_initialization`] say where to begin.
//! - [`certify`] says whether a minimum is the lowest one there is, for noise that is alike in all
//!   directions and errors of rotation measured by the chord.
//! - Of wrong loops a [`Kernel`](crate::least_squares::Kernel) makes less, [`PoseGraph::solve_switched`]
//!   gives each loop a switch, and [`PoseGraph::solve_graduated`] makes up its mind slowly.

mod certificate;
mod chordal;
mod error;
mod graduation;
mod graph;
mod isotropic;
mod keyframes;
mod switches;
mod upright;

pub use certificate::{Certificate, Inapplicable, certify};
pub use chordal::chordal_initialization;
pub use error::LoopClosureError;
pub use graduation::{GraduatedGraph, Graduation, truncated_weight};
pub use graph::{
    GraphProblem, PlanarGraph, PoseGraph, RelativeMeasurement, SolvedGraph, SpatialGraph,
    UprightGraph, pose_graph_options,
};
pub use isotropic::Isotropy;
pub use keyframes::StereoPixels;
pub use switches::SwitchedGraph;
pub use upright::UprightPose;
