//! What a filter is told of its sensors, and what it is to do.

use nalgebra::Vector3;

use crate::consistency::{Linearization, Policy};
use crate::filtering::Form;
use crate::inertial::{Calibrated, GRAVITY, ImuNoise};
use crate::reprojection::Pinhole;
use crate::simulation::Flight;

/// Which pose goes when the window is full.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WindowPolicy {
    /// The oldest one.
    #[default]
    Oldest,
    /// Every third one but the oldest and the newest, all at once, so that what stays spans the same
    /// time ([@mourikis2007]). Two pixels that a track has at them correct the filter before, and it
    /// goes on with the others. A pose for which no pixel waits goes as well.
    Thin,
}

/// How a body at rest is noticed, and what it is then told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// The body is at rest when half of the tracks have moved by less than this since the last picture that was kept,
    /// in pixels.
    pub motion: f64,
    /// The standard deviation of the velocity of a body at rest, in m/s on each axis.
    pub velocity_sigma: f64,
    /// That of its angular velocity, in rad/s on each axis. The noise of the reading by which it is
    /// measured comes on top.
    pub turning_sigma: f64,
}

// ANCHOR: msckf_options
/// What the filter is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MsckfOptions {
    /// The camera.
    pub camera: Pinhole,
    /// The standard deviation of each coordinate of a pixel.
    pub pixel_sigma: f64,
    /// The densities of the noise of the readings and of the walk of their biases.
    pub noise: ImuNoise,
    /// The acceleration of free fall, in the world, in m/s².
    pub gravity: Vector3<f64>,
    /// How many poses the window holds.
    pub clones: usize,
    /// Which of them goes.
    pub policy: WindowPolicy,
    /// Pictures that a track needs to count when it has ended.
    pub least_sights: usize,
    /// Two rays of a track have to meet at this angle, in radians.
    pub least_parallax: f64,
    /// A landmark that would be more uncertain than this if the poses were known is refused, in
    /// metres.
    pub largest_sigma: f64,
    /// The probability that a track without fault passes the gate.
    pub gate: f64,
    /// Where derivatives are taken, and how the estimate moves; a [`Policy`] says it in a word.
    pub linearization: Linearization,
    /// How covariances are corrected.
    pub form: Form,
    /// What of the calibration is estimated.
    pub calibrated: Calibrated,
    /// How many landmarks are kept in the state, at most.
    pub landmarks: usize,
    /// What is done when the body is at rest.
    pub rest: Option<Rest>,
}
// ANCHOR_END: msckf_options

impl MsckfOptions {
    /// Eleven poses, and nothing of the calibration is estimated.
    pub fn new(camera: Pinhole, pixel_sigma: f64, noise: ImuNoise) -> Self {
        Self {
            camera,
            pixel_sigma,
            noise,
            gravity: GRAVITY,
            clones: 11,
            policy: WindowPolicy::Oldest,
            least_sights: 3,
            least_parallax: 1e-3,
            largest_sigma: 10.0,
            gate: 0.99,
            linearization: Policy::Standard.into(),
            form: Form::Difference,
            calibrated: Calibrated::default(),
            landmarks: 0,
            rest: None,
        }
    }

    /// What is true of a simulated flight.
    pub fn of_flight(flight: &Flight) -> Self {
        let Flight { camera, pixel_sigma, noise, gravity, .. } = *flight;
        Self { gravity, ..Self::new(camera, pixel_sigma, noise) }
    }
}
