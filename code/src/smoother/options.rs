//! How a smoother works.

use crate::initialization::Sensors;
use crate::least_squares::{Kernel, Method, Options};

// ANCHOR: options
/// How a smoother works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmootherOptions {
    /// The sensors, and what of their calibration is estimated.
    pub sensors: Sensors,
    /// How long a state stays in the window, in seconds.
    pub lag: f64,
    /// The kernel of the pixels.
    pub kernel: Kernel,
    /// The most steps for a picture.
    pub iterations: usize,
    /// A step that lowers the cost by less than this part of it is the last.
    pub tolerance: f64,
    /// The fewest pictures that must show a landmark.
    pub least_sightings: usize,
    /// The least angle at which two of its rays must meet, in radians.
    pub least_parallax: f64,
    /// How far a pixel may be off where the landmark is expected, in standard deviations.
    pub gate: f64,
    /// Whether what a prior names keeps the linearization point of the prior.
    pub frozen: bool,
}
// ANCHOR_END: options

/// Steps begin with so little damping, by the diagonal, that a covariance does not notice it.
const SMALL_DAMPING: f64 = 1e-9;

impl SmootherOptions {
    /// How the minimum of a window is looked for.
    pub(super) fn search(&self) -> Options {
        Options {
            method: Method::LevenbergMarquardt { initial_damping: SMALL_DAMPING },
            max_iterations: self.iterations,
            decrease_tolerance: self.tolerance,
            ..Options::default()
        }
    }

    /// Those for some sensors: two seconds.
    pub fn new(sensors: Sensors) -> Self {
        Self {
            sensors,
            lag: 2.0,
            kernel: Kernel::Huber(1.345),
            iterations: 1,
            tolerance: 1e-3,
            least_sightings: 3,
            least_parallax: 0.02,
            gate: 30.0,
            frozen: true,
        }
    }
}
