//! What the chapter's theorems say falsely where one of their conditions is dropped.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Matrix4, Vector3, Vector6};
use vislam::manifold::{se3, so3};

use super::oracle::{series, twist_matrix};

/// The longest that a unit vector becomes under the exponential of a symmetric matrix, one with the
/// entries of a quarter turn's hat and only positive signs.
pub fn exponential_of_a_symmetric_matrix() -> f64 {
    let symmetric = so3::hat(&(FRAC_PI_2 * Vector3::z())).abs();
    series(&symmetric).singular_values().max()
}

/// How near the reflection through the origin, an orthogonal matrix, comes to leaving a unit vector
/// alone: the smallest length by which it moves one.
pub fn reflection_without_axis() -> f64 {
    (-Matrix3::<f64>::identity() - Matrix3::identity()).singular_values().min()
}

/// Degrees between the two sides of the adjoint's equation for a mirror and a turn by ten degrees
/// across it.
pub fn mirrored_step() -> f64 {
    let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    let phi = 10_f64.to_radians() * Vector3::x();
    let conjugated = mirror * so3::exp(&phi).matrix() * mirror;
    let claimed = so3::exp(&(mirror * phi));
    let between = claimed.matrix().transpose() * conjugated;
    (0.5 * (between.trace() - 1.0)).acos().to_degrees()
}

/// Metres between the two sides of the adjoint's equation for a step of a metre and a map that
/// doubles lengths.
pub fn step_in_a_larger_world() -> f64 {
    let double = Matrix4::from_diagonal(&nalgebra::Vector4::new(2.0, 2.0, 2.0, 1.0));
    let half = Matrix4::from_diagonal(&nalgebra::Vector4::new(0.5, 0.5, 0.5, 1.0));
    let step = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let conjugated = double * series(&twist_matrix(&step)) * half;
    (conjugated - se3::exp(&step).to_homogeneous()).norm()
}
