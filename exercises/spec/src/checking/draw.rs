//! Random data for instances: the same seed gives the same data everywhere.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Isometry3, Rotation3, SMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws random data.
#[derive(Debug, Clone)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// Draws from a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Draws from a seed that cannot be guessed: trying all of them is as hard as it is long.
    pub fn of_seed(seed: [u8; 32]) -> Self {
        Self(ChaCha8Rng::from_seed(seed))
    }

    /// A number of a range.
    pub fn uniform(&mut self, range: Range<f64>) -> f64 {
        self.0.random_range(range)
    }

    /// A whole number of a range.
    pub fn index(&mut self, range: Range<usize>) -> usize {
        self.0.random_range(range)
    }

    /// Puts things into any order.
    pub fn shuffle<T>(&mut self, things: &mut [T]) {
        for last in (1..things.len()).rev() {
            things.swap(last, self.index(0..last + 1));
        }
    }

    /// A number of the normal distribution with mean zero and variance one.
    pub fn normal(&mut self) -> f64 {
        // Box and Muller. One minus a number below one is never zero.
        let (u, v) = (self.uniform(0.0..1.0), self.uniform(0.0..1.0));
        (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
    }

    /// A matrix of numbers of the normal distribution.
    pub fn normals<const R: usize, const C: usize>(&mut self) -> SMatrix<f64, R, C> {
        SMatrix::from_fn(|_, _| self.normal())
    }

    /// A vector of length one in any direction.
    pub fn direction(&mut self) -> Vector3<f64> {
        self.normals::<3, 1>().normalize()
    }

    /// A vector as long as a number of the range, in any direction.
    pub fn vector(&mut self, length: Range<f64>) -> Vector3<f64> {
        self.uniform(length) * self.direction()
    }

    /// A rotation by an angle of the range, in radians, about any axis.
    pub fn rotation(&mut self, angle: Range<f64>) -> Rotation3<f64> {
        Rotation3::new(self.vector(angle))
    }

    /// A pose whose rotation is by an angle and whose translation has a length of the ranges.
    pub fn pose(&mut self, angle: Range<f64>, distance: Range<f64>) -> Isometry3<f64> {
        let rotation = self.rotation(angle);
        Isometry3::from_parts(self.vector(distance).into(), rotation.into())
    }
}
