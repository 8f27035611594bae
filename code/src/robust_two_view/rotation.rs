//! The rotation between two pictures from one place.

use nalgebra::{Matrix3, Rotation3};

use super::RayPair;
use crate::filtering::rotation_towards;

/// How little a rotation may decide, as a part of the sum over all rays.
const UNDECIDED: f64 = 1e-12;

// ANCHOR: rotation_of_rays
/// The rotation R with which the sum of squared distances between the unit vectors b and R a of all
/// pairs (a, b) is least, `second_from_first`; `None` when another one does as well, as about a
/// single ray.
pub fn rotation_of_rays(pairs: &[RayPair]) -> Option<Rotation3<f64>> {
    let outer = |(first, second): &RayPair| second.normalize() * first.normalize().transpose();
    let moment: Matrix3<f64> = pairs.iter().map(outer).sum();
    let is_finite = moment.iter().all(|entry| entry.is_finite());
    is_finite.then(|| rotation_towards(&moment, UNDECIDED * pairs.len() as f64)).flatten()
}
// ANCHOR_END: rotation_of_rays
