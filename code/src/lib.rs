//! The theory of the book *Visual-Inertial SLAM, Derived and Tested*, one module per
//! chapter; and [`factors`], which several of them share, [`simulation`] and [`datasets`], where data
//! come from.
//!
//! Lengths are in metres, angles in radians, image coordinates in pixels. A camera
//! looks along its +z axis, x points to the right of the image and y down. A transform
//! is named by its frames: `camera_from_world` takes the coordinates of a point in the
//! world to its coordinates in the camera. Points are vectors of three coordinates, and
//! [`manifold::se3::transform`] takes them from frame to frame. `pose * point` would not: for
//! `nalgebra` a `Vector3` is a direction, which a transform turns and does not move.
//!
//! `{eq:label}` in a description names the equation of the book that an item
//! implements, `[@key]` a work of the bibliography.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod bearing;
pub mod bundle_adjustment;
pub mod consistency;
pub mod datasets;
pub mod factors;
pub mod filtering;
pub mod inertial;
pub mod initialization;
pub mod least_squares;
pub mod loop_closure;
pub mod manifold;
pub mod marginalization;
pub mod msckf;
pub mod observability;
pub mod odometry;
pub mod preintegration;
mod registers;
pub mod reprojection;
pub mod robust_two_view;
pub mod simulation;
pub mod smoother;
pub mod structure_from_motion;
pub mod two_views;

/// The examples of the first page that a registry shows.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
