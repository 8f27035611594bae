//! What the controls ask for.

use vislam::least_squares::{Kernel, Problem, ProblemError};
use vislam::simulation::Scene;

use crate::pixels;

/// Keyframes of either ring.
const RIGS: usize = 8;
/// Points of either ring.
const POINTS: usize = 30;
/// Metres between the two cameras of a pair.
const BASELINE: f64 = 0.4;
/// Cameras of the street, and how far they see along it in metres.
const STREET: (usize, f64) = (10, 2.5);
/// Standard deviation of each coordinate of a pixel.
const NOISE: f64 = 1.0;
/// By how many pixels an outlier is off.
const OFF: f64 = 30.0;
/// Kernels with their thresholds in standard deviations.
const KERNELS: [Kernel; 3] = [Kernel::Squared, Kernel::Huber(1.5), Kernel::Cauchy(2.385)];

/// What is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum World {
    /// Cameras along a facade.
    Street,
    /// Single cameras in a circle around points.
    Ring,
    /// The same with a second camera to the right of each.
    StereoRing,
}

/// All controls but the number of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// What is looked at.
    pub world: World,
    /// Whether the first camera, or pair, stays where it is.
    pub held: bool,
    /// What a residual costs.
    pub kernel: Kernel,
    /// Share of the observations that are wrong matches.
    pub outliers: f64,
    /// How far the start lies from the truth, over how far the scene puts it.
    pub start: f64,
    /// Of all that is random.
    pub seed: u64,
}

impl Setting {
    /// The setting and the number of steps, from the values of the controls.
    pub fn of(controls: &[f64]) -> Option<(Self, usize)> {
        let &[steps, world, held, kernel, percent, start, seed] = controls else { return None };
        let worlds = [World::Street, World::Ring, World::StereoRing];
        let setting = Self {
            world: *worlds.get(world as usize)?,
            held: held == 0.0,
            kernel: *KERNELS.get(kernel as usize)?,
            outliers: percent / 100.0,
            start,
            seed: seed as u64,
        };
        Some((setting, steps as usize))
    }

    /// The scene, with its start as far from the truth as is asked for.
    pub fn scene(&self) -> Scene {
        let (cameras, reach) = STREET;
        let scene = match self.world {
            World::Ring => Scene::ring(RIGS, POINTS, NOISE, self.seed),
            World::StereoRing => Scene::stereo_ring(RIGS, POINTS, BASELINE, NOISE, self.seed),
            World::Street => Scene::street(cameras, reach, NOISE, self.seed),
        };
        let scene = scene.with_outliers(self.outliers, OFF, self.seed + 100);
        let mut scene = scene.with_start(self.start);
        if !self.held {
            scene.problem.fixed.fill(false);
        }
        scene
    }

    /// The scene's problem with any kernel.
    pub fn problem(&self, scene: &Scene) -> Result<Problem, ProblemError> {
        pixels::problem(&scene.problem, self.kernel)
    }
}
