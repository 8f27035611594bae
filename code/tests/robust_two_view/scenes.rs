//! Random scenes whose truth is known.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::manifold::se3;
use vislam::reprojection::Pinhole;
use vislam::robust_two_view::RayPair;

pub const CAMERA: Pinhole = Pinhole { fx: 500.0, fy: 510.0, cx: 320.0, cy: 240.0 };

pub fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub fn number(random: &mut ChaCha8Rng) -> f64 {
    random.random_range(-1.0..1.0)
}

pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

pub fn vector(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| number(random))
}

/// A turn of up to a radian or so, and a baseline of one.
pub fn motion(random: &mut ChaCha8Rng) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(0.6 * vector(random));
    Isometry3::from_parts(vector(random).normalize().into(), turn)
}

/// A point in front of both cameras, 2 to 10 baselines away from the first.
pub fn seen_point(random: &mut ChaCha8Rng, second_from_first: &Isometry3<f64>) -> Vector3<f64> {
    loop {
        let slopes = Vector2::new(number(random), number(random));
        let point = random.random_range(2.0..10.0) * slopes.push(1.0);
        if se3::transform(second_from_first, &point).z > 0.5 {
            return point;
        }
    }
}

/// The directions in which both cameras see a point.
pub fn rays(second_from_first: &Isometry3<f64>, point: &Vector3<f64>) -> RayPair {
    (point.normalize(), se3::transform(second_from_first, point).normalize())
}

pub fn five(random: &mut ChaCha8Rng, second_from_first: &Isometry3<f64>) -> [RayPair; 5] {
    std::array::from_fn(|_| rays(second_from_first, &seen_point(random, second_from_first)))
}

/// How far two matrices are from each other, up to sign and scale.
pub fn distance(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    let (a, b) = (a.normalize(), b.normalize());
    (a - b).amax().min((a + b).amax())
}

/// A pixel anywhere in the picture.
pub fn any_pixel(random: &mut ChaCha8Rng) -> Vector2<f64> {
    Vector2::new(random.random_range(0.0..640.0), random.random_range(0.0..480.0))
}

/// A small turn and a baseline of 0.5, to the side for the most part.
pub fn small_motion(random: &mut ChaCha8Rng) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(0.1 * vector(random));
    let across = Vector3::new(1.0, 0.0, 0.0) + 0.5 * vector(random);
    Isometry3::from_parts((0.5 * across.normalize()).into(), turn)
}

/// What lies at which depth.
#[derive(Clone, Copy)]
pub enum World {
    /// Anywhere from 2 to 8.
    Deep,
    /// In one plane that is tilted against the pictures.
    Flat,
}

/// Pixels of `right` points with noise of a pixel, and of `wrong` pairs that have nothing to do with
/// each other behind them.
pub fn pixels(
    random: &mut ChaCha8Rng,
    second_from_first: &Isometry3<f64>,
    world: World,
    right: usize,
    wrong: usize,
) -> Vec<[Vector2<f64>; 2]> {
    let mut pixels = Vec::new();
    while pixels.len() < right {
        let first = any_pixel(random);
        let slopes = vislam::bearing::back_project(&CAMERA, &first, 1.0);
        let depth = match world {
            World::Deep => random.random_range(2.0..8.0),
            World::Flat => 4.0 / Vector3::new(0.3, -0.2, 1.0).dot(&slopes),
        };
        let second = CAMERA.project(second_from_first, &(depth * slopes));
        let is_inside = |pixel: &Vector2<f64>| {
            (0.0..640.0).contains(&pixel.x) && (0.0..480.0).contains(&pixel.y)
        };
        if let Some(second) = second.filter(is_inside) {
            let noise = |random: &mut ChaCha8Rng| Vector2::from_fn(|_, _| normal(random));
            pixels.push([first + noise(random), second + noise(random)]);
        }
    }
    pixels.extend((0..wrong).map(|_| [any_pixel(random), any_pixel(random)]));
    pixels
}
