//! Random poses and graphs.

use nalgebra::{Isometry3, Matrix6, SMatrix, Vector6};
use vislam::loop_closure::{PoseGraph, RelativeMeasurement, SpatialGraph};
use vislam::manifold::se3;

use crate::random::Random;

/// A twist with these standard deviations of its translation and of its rotation.
pub fn twist(random: &mut Random, along: f64, about: f64) -> Vector6<f64> {
    Vector6::from_fn(|row, _| random.normal(if row < 3 { along } else { about }))
}

/// A pose anywhere within a few metres, turned by any angle.
pub fn pose(random: &mut Random) -> Isometry3<f64> {
    se3::exp(&twist(random, 3.0, 1.0))
}

/// A covariance in which everything is correlated.
pub fn covariance<const D: usize>(random: &mut Random) -> SMatrix<f64, D, D> {
    let root = SMatrix::<f64, D, D>::from_fn(|_, _| random.normal(1.0));
    root * root.transpose() + SMatrix::<f64, D, D>::identity()
}

/// The information of errors with these standard deviations along and about each axis.
pub fn isotropic(along: f64, about: f64) -> Matrix6<f64> {
    let variances = Vector6::from_fn(|row, _| (if row < 3 { along } else { about }).powi(-2));
    Matrix6::from_diagonal(&variances)
}

/// The second pose as measured from the first one, with errors of these standard deviations.
pub fn measure(
    poses: &[Isometry3<f64>],
    [first, second]: [usize; 2],
    [along, about]: [f64; 2],
    random: &mut Random,
) -> RelativeMeasurement<Isometry3<f64>, 6> {
    let error = se3::exp(&twist(random, along, about));
    let measured = poses[first].inv_mul(&poses[second]) * error;
    RelativeMeasurement { first, second, measured, information: isotropic(along, about) }
}

/// Five poses, most of them measured from most others, with large errors.
pub fn tangled(random: &mut Random) -> SpatialGraph {
    let poses: Vec<_> = (0..5).map(|_| pose(random)).collect();
    let pairs = (0..5).flat_map(|first| (first + 1..5).map(move |second| [first, second]));
    let pairs = pairs.filter(|[first, second]| second - first == 1 || (first + second) % 3 == 0);
    let measurements = pairs.map(|pair| measure(&poses, pair, [0.1, 0.6], random)).collect();
    PoseGraph { poses, measurements }
}
