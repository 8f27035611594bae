//! What an estimator may not know, and how it comes to believe that it does.
//!
//! Shifts of everything and turns about the vertical are seen by no sensor. [`Policy`] names ways to
//! linearize, [`Chart`] the coordinates in which the free directions are the same at every estimate,
//! [`Claimed`] and [`certificate`] what a filter has come to know along them all the same.

mod chart;
mod free;
mod policy;

pub use chart::{Chart, Transport};
pub use free::{Claimed, certificate, constrained};
pub use policy::{Linearization, NoSuchPolicy, Point, Policy};
