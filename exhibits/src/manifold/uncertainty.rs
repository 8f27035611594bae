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
    /// Noise with this covariance, which is positive definite or zero.
    pub fn new(covariance: &Matrix6<f64>, seed: u64) -> Self {
        let root = covariance.cholesky().map_or_else(Matrix6::zeros, |cholesky| cholesky.l());
        Self { root, random: Random::new(seed) }
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
    let deviations = Vector6::new(metres, metres, metres, radians, radians, radians);
    let mixed = Matrix6::from_fn(|row, column| {
        let share =
            if row == column { random.uniform(0.4..1.0) } else { random.uniform(-0.4..0.4) };
        share * deviations[row]
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

/// A robot that drives straight on, a step at a time, and never quite in the direction in which it
/// believes to look.
pub struct Drive {
    /// Metres of one step.
    pub step: f64,
    pub steps: usize,
    /// Standard deviation of the heading that each step adds, in radians.
    pub heading: f64,
    /// Standard deviation of the position that each step adds, along and across, in metres.
    pub position: f64,
}

impl Drive {
    pub const WORKED: Self = Self { step: 1.0, steps: 20, heading: 0.09, position: 0.02 };

    /// The covariance of one step in the body's frame. What the plane does not know is zero.
    fn step_covariance(&self) -> Matrix6<f64> {
        let (position, heading) = (self.position.powi(2), self.heading.powi(2));
        Matrix6::from_diagonal(&Vector6::new(position, position, 0.0, 0.0, 0.0, heading))
    }

    pub fn expected(&self) -> Isometry3<f64> {
        Isometry3::translation(self.step * self.steps as f64, 0.0, 0.0)
    }

    /// The covariance at the end, by first-order composition.
    pub fn covariance(&self) -> Matrix6<f64> {
        let step = se3::adjoint(&Isometry3::translation(-self.step, 0.0, 0.0));
        (0..self.steps)
            .fold(Matrix6::zeros(), |sum, _| step * sum * step.transpose() + self.step_covariance())
    }

    /// Where the robot ends.
    pub fn draw(&self, random: &mut Random) -> Isometry3<f64> {
        (0..self.steps).fold(Isometry3::identity(), |pose, _| {
            let along = random.normal(self.position);
            let across = random.normal(self.position);
            let turn = random.normal(self.heading);
            let noise = Vector6::new(along, across, 0.0, 0.0, 0.0, turn);
            se3::retract(&(pose * Isometry3::translation(self.step, 0.0, 0.0)), &noise)
        })
    }
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
