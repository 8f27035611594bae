//! A ground truth that wanders: a random process that is smooth and stays where it is.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::random::Random;

/// Each component has a standard deviation and forgets its value within some times `tau` seconds.
#[derive(Debug, Clone, Copy)]
pub struct Wander {
    pub sigma: f64,
    pub tau: f64,
}

/// The correlation of a component with itself `t` seconds later.
pub fn correlation(tau: f64, t: f64) -> f64 {
    (1.0 + t / tau) * (-t / tau).exp()
}

impl Wander {
    /// The mean square of how far a vector of three has come after `t` seconds.
    pub fn spread(&self, t: f64) -> f64 {
        6.0 * self.sigma.powi(2) * (1.0 - correlation(self.tau, t))
    }

    /// The wander whose spread fits mean squares best, in the sense of their logarithms.
    pub fn fitted(times: &[f64], squares: &[f64]) -> Self {
        let fit = |tau: f64| {
            let logs: Vec<f64> = times
                .iter()
                .zip(squares)
                .map(|(t, square)| (square / Self { sigma: 1.0, tau }.spread(*t)).ln())
                .collect();
            let mean = logs.iter().sum::<f64>() / logs.len() as f64;
            let misfit: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
            (misfit, Self { sigma: (0.5 * mean).exp(), tau })
        };
        let candidates = (0..=1200).map(|k| fit(0.03 * 1000_f64.powf(f64::from(k) / 1200.0)));
        candidates.min_by(|a, b| a.0.total_cmp(&b.0)).expect("candidates").1
    }

    /// Values at times `step` seconds apart.
    pub fn drawn(&self, random: &mut Random, step: f64, count: usize) -> Vec<Vector3<f64>> {
        let rate = 1.0 / self.tau;
        let decay = (-rate * step).exp();
        let forward =
            decay * Matrix2::new(1.0 + rate * step, step, -rate * rate * step, 1.0 - rate * step);
        let settled = self.sigma.powi(2) * Matrix2::from_diagonal(&Vector2::new(1.0, rate * rate));
        let fresh = settled - forward * settled * forward.transpose();
        let [start, fresh] = [settled, fresh].map(|m| m.cholesky().expect("a covariance").l());
        let mut draw = |root: &Matrix2<f64>| {
            [0; 3].map(|_| root * Vector2::new(random.normal(1.0), random.normal(1.0)))
        };
        let mut state = draw(&start);
        let mut values = Vec::with_capacity(count);
        for _ in 0..count {
            values.push(Vector3::new(state[0].x, state[1].x, state[2].x));
            let noise = draw(&fresh);
            state = std::array::from_fn(|axis| forward * state[axis] + noise[axis]);
        }
        values
    }
}
