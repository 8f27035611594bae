//! Noisy poses, and the covariance that a cloud of them has.

use nalgebra::{Isometry3, Matrix6, SMatrix, SVector, Vector6};
use vislam::manifold::se3;

use crate::random::Random;

/// Draws from a normal distribution in the tangent space.
pub struct Noise {
    root: Matrix6<f64>,
    random: Random,
}

impl Noise {
    /// Noise with this covariance.
    pub fn new(covariance: &Matrix6<f64>, seed: u64) -> Self {
        let root = covariance.cholesky().expect("it is positive definite").l();
        Self { root, random: Random::new(seed) }
    }

    /// Noise with these standard deviations, which may be zero.
    pub fn independent(deviations: &Vector6<f64>, seed: u64) -> Self {
        Self { root: Matrix6::from_diagonal(deviations), random: Random::new(seed) }
    }

    pub fn draw(&mut self) -> Vector6<f64> {
        self.root * Vector6::from_fn(|_, _| self.random.normal(1.0))
    }

    /// The pose, moved in its own frame.
    pub fn around(&mut self, pose: &Isometry3<f64>) -> Isometry3<f64> {
        se3::retract(pose, &self.draw())
    }
}

/// A covariance whose six deviations differ and are correlated.
pub fn covariance(random: &mut Random, metres: f64, radians: f64) -> Matrix6<f64> {
    let mixed = Matrix6::from_fn(|row, column| {
        let range = if row == column { 0.4..1.0 } else { -0.4..0.4 };
        random.uniform(range) * if row < 3 { metres } else { radians }
    });
    mixed * mixed.transpose()
}

/// The covariance about zero of the draws.
pub fn sample_covariance<const N: usize>(
    draws: usize,
    mut draw: impl FnMut() -> SVector<f64, N>,
) -> SMatrix<f64, N, N> {
    let mut sum = SMatrix::zeros();
    for _ in 0..draws {
        let vector = draw();
        sum += vector * vector.transpose();
    }
    sum / draws as f64
}

/// A robot that starts with a doubtful heading and drives straight on.
pub struct Drive {
    /// Metres driven.
    pub length: f64,
    /// Deviations of the start: along and across in metres, heading in radians.
    pub start: [f64; 3],
    /// Deviations that the drive adds.
    pub way: [f64; 3],
}

impl Drive {
    pub const WORKED: Self = Self { length: 10.0, start: [0.2, 0.2, 0.35], way: [0.2, 0.2, 0.035] };

    pub fn expected(&self) -> Isometry3<f64> {
        Isometry3::translation(self.length, 0.0, 0.0)
    }

    /// The covariance at the end in the frame of the robot, by first-order composition.
    pub fn covariance(&self) -> Matrix6<f64> {
        let back = se3::adjoint(&self.expected().inverse());
        let squares = |deviations| Matrix6::from_diagonal(&planar(deviations).map(|d| d * d));
        back * squares(self.start) * back.transpose() + squares(self.way)
    }

    /// Poses in which the robot may end, in the frame of its expected start.
    pub fn ends(&self, seed: u64) -> impl Iterator<Item = Isometry3<f64>> + use<> {
        let mut start = Noise::independent(&planar(self.start), seed);
        let mut way = Noise::independent(&planar(self.way), seed + 1);
        let expected = self.expected();
        std::iter::repeat_with(move || start.around(&Isometry3::identity()) * way.around(&expected))
    }
}

/// The twist of these numbers along, across and in heading.
fn planar([along, across, heading]: [f64; 3]) -> Vector6<f64> {
    Vector6::new(along, across, 0.0, 0.0, 0.0, heading)
}

/// The coordinates of a twist in the plane: along, across, heading.
pub fn in_plane(xi: &Vector6<f64>) -> SVector<f64, 3> {
    SVector::from([xi[0], xi[1], xi[5]])
}

/// The rows and columns of a covariance that belong to the plane.
pub fn plane_of(covariance: &Matrix6<f64>) -> SMatrix<f64, 3, 3> {
    let kept = [0, 1, 5];
    SMatrix::from_fn(|row, column| covariance[(kept[row], kept[column])])
}
