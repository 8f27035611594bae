//! How a smoother works.

use crate::initialization::Sensors;
use crate::least_squares::{Kernel, Method, Options};
use crate::reprojection::RigCamera;

// ANCHOR: parametrization
/// By which three numbers a landmark is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Parametrization {
    /// Its coordinates in the world, in metres. It is begun when its rays meet at an angle.
    #[default]
    Point,
    /// Ray and inverse depth in the first picture of it, its anchor ([@civera2008]). Nothing is divided by
    /// the inverse depth, so a landmark may be as far off as it likes.
    ///
    /// When the anchor leaves the window, so does the landmark, with all its pixels until then. A track that
    /// goes on begins another landmark of later pixels alone, or the landmark is carried over to another
    /// anchor before: either way no pixel counts twice.
    InverseDepth {
        /// A landmark whose rays meet at no angle is begun as well when its inverse depth, with the states
        /// as they are, has no larger standard deviation than this, in 1/m. Zero begins none of them.
        largest_sigma: f64,
        /// Whether a landmark that is still seen is carried over to the newest picture that saw it. Then the
        /// prior says of it what it would say of a point, and takes longer: it names all such landmarks
        /// and their anchors. Without that it names states alone, and what is known of a landmark
        /// ends with its anchor.
        is_carried: bool,
    },
}

impl Parametrization {
    /// Inverse depth, and what would show at ten metres is begun wherever it is.
    pub const INVERSE_DEPTH: Self = Self::InverseDepth { largest_sigma: 0.05, is_carried: false };
}
// ANCHOR_END: parametrization

// ANCHOR: keyframes
/// Which pictures stay in the window when the next one comes. Each is a state as long as it is the
/// newest; of one that does not stay, only the readings are kept, to be summed up with later ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Keyframes {
    /// All of them.
    #[default]
    Every,
    /// Those in which at least half of the tracks have moved since the last one that stays.
    Moved {
        /// By how much, in pixels.
        pixels: f64,
        /// After so many seconds a picture stays all the same. Readings are kept for as long.
        most_seconds: f64,
    },
}
// ANCHOR_END: keyframes

// ANCHOR: options
/// How a smoother works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmootherOptions {
    /// The sensors, and what of their calibration is estimated.
    pub sensors: Sensors,
    /// A second camera on the rig of the first one, which saw the right pixels of features. Without one
    /// they are not looked at. It keeps its pose in the first camera, also when that of the first camera
    /// on the body is estimated.
    pub right: Option<RigCamera>,
    /// How a landmark is parametrized.
    pub landmarks: Parametrization,
    /// How old the second state of the window becomes before the oldest one leaves, in seconds.
    pub lag: f64,
    /// Which states stay so long.
    pub keyframes: Keyframes,
    /// The kernel of the pixels.
    pub kernel: Kernel,
    /// The most steps for a picture.
    pub iterations: usize,
    /// Of several steps for a picture, one that lowers the cost by less than this part of it is the last.
    pub tolerance: f64,
    /// The fewest pictures that must show a landmark; of a pair of pixels, one does.
    pub least_sightings: usize,
    /// The least angle at which two of its rays must meet, in radians.
    pub least_parallax: f64,
    /// The same in standard deviations of a ray, which is a pixel's over the focal length. At less, noise alone
    /// may show a far landmark near, and which ones are begun depends on their noise.
    pub least_parallax_sigmas: f64,
    /// How far a pixel may be off where the landmark is expected, in standard deviations.
    pub gate: f64,
    /// Whether what a prior names keeps the linearization point of the prior.
    pub frozen: bool,
}
// ANCHOR_END: options

impl SmootherOptions {
    /// How the minimum of a window is looked for. The first step is not damped: readings fix the place of a
    /// state beside its neighbours so well that hardly any damping would hold the whole window where it is.
    pub(super) fn search(&self) -> Options {
        Options {
            method: Method::LevenbergMarquardt { initial_damping: 0.0 },
            max_iterations: self.iterations,
            // A single step is taken, however little it is beside all that the window says.
            decrease_tolerance: if self.iterations == 1 { 0.0 } else { self.tolerance },
            ..Options::default()
        }
    }

    /// The least angle at which two rays of a landmark must meet, with the noise of the pixels.
    pub fn least_angle(&self) -> f64 {
        let ray_sigma = self.sensors.pixel_sigma / self.sensors.camera.fx;
        self.least_parallax.max(self.least_parallax_sigmas * ray_sigma)
    }

    /// Those for some sensors: two seconds.
    pub fn new(sensors: Sensors) -> Self {
        Self {
            sensors,
            right: None,
            landmarks: Parametrization::Point,
            lag: 2.0,
            keyframes: Keyframes::Every,
            kernel: Kernel::Huber(1.345),
            iterations: 1,
            tolerance: 1e-3,
            least_sightings: 3,
            least_parallax: 0.02,
            least_parallax_sigmas: 5.0,
            gate: 30.0,
            frozen: true,
        }
    }
}
