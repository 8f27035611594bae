//! What a filter promises: whether its errors keep the promise, and which fault breaks it.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub use crate::navigation::State;
pub use vislam::preintegration::Matrix9;

#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
pub use checks::*;

// ANCHOR: parts
/// The NEES of the parts of a state, each divided by its dimension.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Parts {
    /// Three numbers.
    pub position: f64,
    /// Three numbers.
    pub velocity: f64,
    /// Two numbers: the rotation about horizontal axes.
    pub tilt: f64,
    /// One number: the rotation about the vertical.
    pub yaw: f64,
}
// ANCHOR_END: parts

// ANCHOR: campaign
/// Many independent runs of one filter, each with noise of its own.
///
/// A vehicle moves in the plane. The filter has an error of position, of velocity and of the
/// accelerometer's bias, two numbers each; at the start it knows the velocity exactly, and of the
/// two others as much as it says. Each step integrates one reading of the accelerometer. From time
/// to time a camera measures the displacement since the last clone of the position. The filter
/// uses it and then makes a new clone; the first one was made at the start. In a single step the
/// bias moves the velocity by less than a fifth of what noise does. From one displacement to the
/// next there are steps enough for every fault that acts in them to show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// How many runs there are.
    pub runs: usize,
    /// In the order of time. The first one is made after a single step.
    pub reports: Vec<Report>,
}
// ANCHOR_END: campaign

// ANCHOR: report
/// Means over the runs, of NEES and NIS divided by their dimension, which is two.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Steps since the start.
    pub steps: usize,
    /// Displacements that have been used.
    pub displacements: usize,
    /// NEES of the position.
    pub position: f64,
    /// NEES of the velocity.
    pub velocity: f64,
    /// NEES of the bias.
    pub bias: f64,
    /// NIS of the displacement that was used last; `None` when it stands in a report before this
    /// one, or when there is none.
    pub displacement: Option<f64>,
}
// ANCHOR_END: report

// ANCHOR: fault
/// What is wrong with the covariance of a filter. All else that it does is right: it integrates
/// readings and measures displacements as it should, and makes its gain of the covariance it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// Nothing.
    None,
    /// The density of the accelerometer's noise is taken for something else: what a step adds to
    /// the variance of the velocity is dt or 1/dt times what it should be; dt is below 0.05.
    Density,
    /// A term of the transition is missing: the one by which the bias enters the velocity, or the
    /// one by which the velocity enters the position.
    Transition,
    /// Clones have the right variance, and no covariance with the rest of the state.
    Clones,
}
// ANCHOR_END: fault

crate::signatures! {
    // ANCHOR: parts_of
    /// The NEES of an estimate in parts: eᵀ P⁻¹ e / d for an error e of d numbers, P being the
    /// covariance of these numbers.
    ///
    /// `covariance` is that of the step (φ, ν, ρ), in this order, from the estimate to the truth,
    /// all of it **in the body frame of the estimate**: R̂ exp(φ) is the true rotation, v̂ + R̂ ν the
    /// true velocity, p̂ + R̂ ρ the true position. It is positive definite.
    ///
    /// Tilt and yaw are parts of the rotation that the **world** sees, the rotation vector θ of
    /// exp(θ) R̂, which is the true rotation. Yaw is its coordinate along `up`, a vector of length
    /// one in the world, which need not be an axis of the world. Tilt are its coordinates along
    /// two horizontal axes at right angles to each other; it does not matter which.
    fn parts_of(estimate: State, truth: State, covariance: Matrix9, up: Vector3<f64>) -> Parts;
    // ANCHOR_END: parts_of

    // ANCHOR: band
    /// The lower and the upper end of the band in which a mean of NEES or NIS lies when the filter
    /// is consistent. Its errors are normal and independent from run to run.
    ///
    /// Run k has an error of `dimensions[k]` numbers. The mean is the sum of all eᵀ P⁻¹ e, over the
    /// runs, divided by the sum of their dimensions. So many `tests` are made like this one, and a
    /// consistent filter may leave any of their bands with the probability `outside` at most:
    /// every end of every band has an equal share of it. There is at least one run and one test,
    /// no dimension is zero, and `outside` is between zero and one.
    fn band(dimensions: Vec<usize>, tests: usize, outside: f64) -> (f64, f64);
    // ANCHOR_END: band

    // ANCHOR: diagnosis
    /// Which fault the filter of a campaign has. It has one at most.
    ///
    /// Every number of every report is a test, and `outside` is the probability with which all of
    /// them together may call a consistent filter faulty. So the verdict is [`Fault::None`] when
    /// every number lies in its band, and never otherwise.
    fn diagnosis(campaign: Campaign, outside: f64) -> Fault;
    // ANCHOR_END: diagnosis
}
