//! Flights in laps, with loops from each lap to the one before.

use nalgebra::{Isometry3, Matrix6, Translation3, UnitQuaternion, Vector6};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::loop_closure::{PoseGraph, RelativeMeasurement, SpatialGraph};
use vislam::manifold::se3;

/// Normal random numbers.
pub struct Draws(ChaCha8Rng);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn number(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A twist with these standard deviations of its translation and of its rotation.
    pub fn twist(&mut self, along: f64, about: f64) -> Vector6<f64> {
        Vector6::from_fn(|row, _| self.number() * if row < 3 { along } else { about })
    }
}

/// Two laps of so many poses on a circle of ten metres, up and down and tilted.
pub fn laps(poses: usize) -> Vec<Isometry3<f64>> {
    let pose = |number: usize| {
        let angle = number as f64 * std::f64::consts::TAU / poses as f64;
        let lap = (number / poses) as f64;
        let position =
            Translation3::new(10.0 * angle.cos(), 10.0 * angle.sin(), (3.0 * angle).sin() + lap);
        let (roll, pitch) = (0.2 * (2.0 * angle).sin(), 0.1 * angle.cos());
        Isometry3::from_parts(position, UnitQuaternion::from_euler_angles(roll, pitch, angle))
    };
    (0..2 * poses).map(pose).collect()
}

/// The second pose as measured from the first one, with errors of these standard deviations.
pub fn measure(
    poses: &[Isometry3<f64>],
    [first, second]: [usize; 2],
    [along, about]: [f64; 2],
    draws: &mut Draws,
) -> RelativeMeasurement<Isometry3<f64>, 6> {
    let error = se3::exp(&draws.twist(along, about));
    let variances =
        Vector6::from_fn(|row, _| (if row < 3 { along } else { about }).max(1e-3).powi(2));
    RelativeMeasurement {
        first,
        second,
        measured: poses[first].inv_mul(&poses[second]) * error,
        information: Matrix6::from_diagonal(&variances.map(f64::recip)),
    }
}

/// Two laps, and their graph: odometry, and every fifth pose of the second lap as seen from the first
/// one. The poses of the graph follow from the odometry.
pub fn noisy_laps(
    poses: usize,
    along: f64,
    about: f64,
    seed: u64,
) -> (Vec<Isometry3<f64>>, SpatialGraph) {
    let (truth, mut draws) = (laps(poses), Draws::new(seed));
    let odometry = (1..truth.len()).map(|number| [number - 1, number]);
    let loops = (0..poses).step_by(5).map(|number| [number, number + poses]);
    let sigmas = [along, about];
    let measurements =
        odometry.chain(loops).map(|pair| measure(&truth, pair, sigmas, &mut draws)).collect();
    let mut graph = PoseGraph { poses: truth.clone(), measurements };
    graph.poses = graph.chained().unwrap();
    (truth, graph)
}

/// The largest distance between positions, in metres.
pub fn largest_error(poses: &[Isometry3<f64>], truth: &[Isometry3<f64>]) -> f64 {
    let distance = |(pose, truth): (&Isometry3<f64>, &Isometry3<f64>)| {
        (pose.translation.vector - truth.translation.vector).norm()
    };
    poses.iter().zip(truth).map(distance).fold(0.0, f64::max)
}
