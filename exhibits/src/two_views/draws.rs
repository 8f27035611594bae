//! Points from noisy pixels, again and again.

use nalgebra::{Vector2, Vector3};
use vislam::two_views::{View, triangulate, triangulate_nonlinear};

use crate::random::Random;

/// What became of many noisy copies of the same views.
#[derive(Default)]
pub struct Draws {
    /// The linear points.
    pub linear: Vec<Vector3<f64>>,
    /// The most likely points, in the same order.
    pub likely: Vec<Vector3<f64>>,
    /// How many copies gave no point.
    pub without_point: usize,
    /// Steps to the most likely points, all together.
    pub steps: usize,
}

impl Draws {
    /// Noise of one pixel in each coordinate of each view. Every draw is followed by the one with
    /// the opposite noise, so that what is linear in the noise cancels in a mean.
    pub fn of<const N: usize>(views: &[View; N], pairs: usize, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut draws = Self::default();
        for _ in 0..pairs {
            let noise = views.map(|_| Vector2::new(random.normal(1.0), random.normal(1.0)));
            for sign in [1.0, -1.0] {
                let mut noisy = *views;
                for (view, noise) in noisy.iter_mut().zip(&noise) {
                    view.pixel += sign * noise;
                }
                draws.add(&noisy);
            }
        }
        draws
    }

    fn add(&mut self, noisy: &[View]) {
        let linear = triangulate(noisy, 0.0);
        match linear.and_then(|linear| Ok((linear, triangulate_nonlinear(noisy, &linear)?))) {
            Ok((linear, likely)) => {
                self.linear.push(linear);
                self.likely.push(likely.point);
                self.steps += likely.iterations;
            }
            Err(_) => self.without_point += 1,
        }
    }

    /// Share of the copies that gave no point.
    pub fn share_without_point(&self) -> f64 {
        self.without_point as f64 / (self.without_point + self.likely.len()) as f64
    }
}

/// Mean error along an axis.
pub fn mean_error(points: &[Vector3<f64>], truth: &Vector3<f64>, axis: usize) -> f64 {
    points.iter().map(|point| point[axis] - truth[axis]).sum::<f64>() / points.len() as f64
}

/// Root of the mean squared error along an axis.
pub fn rms_error(points: &[Vector3<f64>], truth: &Vector3<f64>, axis: usize) -> f64 {
    let squares = points.iter().map(|point| (point[axis] - truth[axis]).powi(2));
    (squares.sum::<f64>() / points.len() as f64).sqrt()
}
