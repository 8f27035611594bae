//! Points from noisy pixels, again and again.

use std::sync::OnceLock;

use nalgebra::{Vector2, Vector3};
use vislam::two_views::{View, triangulate, triangulate_nonlinear};

use super::worked::{approach, depth_sigma_of, point_at, side_by_side};
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

/// Draws of the point that a robot drives towards.
pub fn on_the_drive() -> &'static Draws {
    static DRAWS: OnceLock<Draws> = OnceLock::new();
    DRAWS.get_or_init(|| Draws::of(&approach().1, 5000, 41))
}

/// Draws of the worked point's ray at one depth, by two cameras side by side.
pub struct AtDepth {
    /// Metres.
    pub baseline: f64,
    pub depth: f64,
    /// Of the depth, to first order, in metres.
    pub sigma: f64,
    pub point: Vector3<f64>,
    pub draws: Draws,
}

impl AtDepth {
    /// All of these depths from all of these baselines.
    pub fn all<const B: usize, const D: usize>(
        baselines: [f64; B],
        depths: [f64; D],
        (pairs, seed): (usize, u64),
    ) -> [[Self; D]; B] {
        baselines.map(|baseline| {
            depths.map(|depth| {
                let point = point_at(depth);
                let draws = Draws::of(&side_by_side(&point, baseline), pairs, seed);
                Self { baseline, depth, sigma: depth_sigma_of(baseline, depth), point, draws }
            })
        })
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
