//! Random states, the same on every machine and in every run.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Rotation3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::reprojection::Pinhole;

/// A seeded source of random numbers, cameras and points.
pub struct Random(ChaCha8Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn uniform(&mut self, range: Range<f64>) -> f64 {
        self.0.random_range(range)
    }

    /// A positive number whose logarithm is uniform, for quantities that span several sizes.
    pub fn logarithmic(&mut self, range: Range<f64>) -> f64 {
        self.uniform(range.start.ln()..range.end.ln()).exp()
    }

    /// A draw from the normal distribution with mean zero, by the method of Box and Muller.
    pub fn normal(&mut self, sigma: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform(0.0..1.0)).ln()).sqrt();
        sigma * radius * (TAU * self.uniform(0.0..1.0)).cos()
    }

    /// A camera whose two focal lengths differ, so that exchanging them is noticed.
    pub fn camera(&mut self) -> Pinhole {
        let fx = self.logarithmic(200.0..1500.0);
        Pinhole {
            fx,
            fy: fx * self.uniform(1.05..1.3),
            cx: self.uniform(250.0..700.0),
            cy: self.uniform(150.0..500.0),
        }
    }

    /// A point in camera coordinates, up to 40 degrees off the axis to each side.
    pub fn point(&mut self, depth: Range<f64>) -> Vector3<f64> {
        let slope = 40_f64.to_radians().tan();
        let (x, y) = (self.uniform(-slope..slope), self.uniform(-slope..slope));
        self.logarithmic(depth) * Vector3::new(x, y, 1.0)
    }

    /// A vector of given length in any direction.
    pub fn direction(&mut self, length: f64) -> Vector3<f64> {
        let components = Vector3::from_fn(|_, _| self.normal(1.0));
        length * Unit::new_normalize(components).into_inner()
    }

    /// A rotation about any axis, by an angle of up to `largest_angle` radians.
    pub fn rotation(&mut self, largest_angle: f64) -> Rotation3<f64> {
        let angle = self.uniform(0.0..largest_angle);
        Rotation3::new(self.direction(angle))
    }
}
