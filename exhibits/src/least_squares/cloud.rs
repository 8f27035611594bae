//! Estimates from other readings of the same tapes.

use nalgebra::{Matrix2, Vector2};
use vislam::filtering::chi_square_quantile;

use super::worked::{self, Tape};
use crate::comparison::inverse;
use crate::random::Random;

/// Estimates that lie around the one from the readings at hand, which stands for the truth.
pub struct Cloud {
    pub centre: Vector2<f64>,
    /// To first order.
    pub covariance: Matrix2<f64>,
    pub estimates: Vec<Vector2<f64>>,
}

impl Cloud {
    pub fn of(tapes: &[Tape], draws: usize, seed: u64) -> Self {
        let centre = worked::estimate(tapes);
        let covariance = inverse(worked::hessian(tapes, &centre));
        let mut random = Random::new(seed);
        let estimates = (0..draws).map(|_| {
            let other = tapes.iter().map(|tape| {
                let measured = tape.length_at(&centre) + random.normal(tape.sigma);
                Tape { measured, ..*tape }
            });
            worked::estimate(&other.collect::<Vec<_>>())
        });
        Self { centre, covariance, estimates: estimates.collect() }
    }

    /// Scatter of one coordinate around the centre.
    pub fn deviation(&self, axis: usize) -> f64 {
        let squares = self.estimates.iter().map(|spot| (spot[axis] - self.centre[axis]).powi(2));
        (squares.sum::<f64>() / self.estimates.len() as f64).sqrt()
    }

    /// How many percent lie in the ellipse that should hold 95 %, by the covariance.
    pub fn inside_percent(&self) -> f64 {
        let (information, largest) =
            (inverse(self.covariance), chi_square_quantile(0.95, 2).expect("a probability"));
        let inside = self.estimates.iter().filter(|spot| {
            let error = *spot - self.centre;
            error.dot(&(information * error)) <= largest
        });
        100.0 * inside.count() as f64 / self.estimates.len() as f64
    }

    /// The outline of that ellipse.
    pub fn ellipse(&self) -> Vec<(f64, f64)> {
        let radius = chi_square_quantile(0.95, 2).expect("a probability").sqrt();
        let root = self.covariance.cholesky().expect("it is positive definite").l();
        let around = (0..=90).map(|step| {
            let (sine, cosine) = (f64::from(step) * 4.0).to_radians().sin_cos();
            let spot = self.centre + radius * root * Vector2::new(cosine, sine);
            (spot.x, spot.y)
        });
        around.collect()
    }
}
