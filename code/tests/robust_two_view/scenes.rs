//! Random scenes whose truth is known.

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::manifold::se3;
use vislam::robust_two_view::RayPair;

pub fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub fn number(random: &mut ChaCha8Rng) -> f64 {
    random.random_range(-1.0..1.0)
}

pub fn vector(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| number(random))
}

/// A turn of up to a radian or so and a baseline of one.
pub fn motion(random: &mut ChaCha8Rng) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(0.6 * vector(random));
    Isometry3::from_parts(vector(random).normalize().into(), turn)
}

/// A point in front of the first camera, 2 to 10 baselines away.
pub fn point(random: &mut ChaCha8Rng) -> Vector3<f64> {
    let slopes = Vector2::new(number(random), number(random));
    random.random_range(2.0..10.0) * slopes.push(1.0)
}

/// The directions in which both cameras see a point.
pub fn rays(second_from_first: &Isometry3<f64>, point: &Vector3<f64>) -> RayPair {
    (point.normalize(), se3::transform(second_from_first, point).normalize())
}

/// A point that both cameras have in front of them.
pub fn seen_point(random: &mut ChaCha8Rng, second_from_first: &Isometry3<f64>) -> Vector3<f64> {
    loop {
        let point = point(random);
        if se3::transform(second_from_first, &point).z > 0.5 {
            return point;
        }
    }
}

pub fn five(random: &mut ChaCha8Rng, second_from_first: &Isometry3<f64>) -> [RayPair; 5] {
    std::array::from_fn(|_| rays(second_from_first, &seen_point(random, second_from_first)))
}
