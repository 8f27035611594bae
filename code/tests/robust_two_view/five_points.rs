//! Five points.

use nalgebra::{DMatrix, Isometry3, Matrix3, SMatrix, Vector3};
use vislam::least_squares::Manifold;
use vislam::robust_two_view::{
    FivePointError, RayPair, RelativeMotion, five_points, motions_of_five, real_roots,
};

use super::scenes::{five, motion, number, random, rays, vector};

/// The larger of the two distances, of two matrices up to sign and scale.
fn distance(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    let (a, b) = (a.normalize(), b.normalize());
    (a - b).amax().min((a + b).amax())
}

/// The condition number of the five equations, by differences over the manifold.
fn condition(motion: &RelativeMotion, pairs: &[RayPair; 5]) -> f64 {
    let volume = |motion: &RelativeMotion, pair: &RayPair| pair.1.dot(&(motion.essential() * pair.0));
    let mut jacobian = SMatrix::<f64, 5, 5>::zeros();
    for axis in 0..5 {
        let moved = |by: f64| {
            let mut step = [0.0; 5];
            step[axis] = by;
            motion.retract(&step)
        };
        let (ahead, behind) = (moved(1e-5), moved(-1e-5));
        for (row, pair) in pairs.iter().enumerate() {
            jacobian[(row, axis)] = (volume(&ahead, pair) - volume(&behind, pair)) / 2e-5;
        }
    }
    let values = jacobian.svd(false, false).singular_values;
    values.max() / values.min()
}

#[test]
fn the_true_motion_is_among_those_of_five_points() {
    let mut random = random(1);
    let (mut worst, mut lost, mut counted, mut total) = (0.0_f64, 0, 0, 0);
    for _ in 0..10_000 {
        let pose = motion(&mut random);
        let pairs = five(&mut random, &pose);
        let truth = RelativeMotion::of(&pose).unwrap();
        if condition(&truth, &pairs) > 1e6 {
            continue;
        }
        counted += 1;
        let found = five_points(&pairs).unwrap();
        total += found.len();
        let error = found.iter().map(|e| distance(e, &truth.essential())).fold(1.0, f64::min);
        if error > 1e-8 { lost += 1; println!("lost {error:e} condition {:e}", condition(&truth, &pairs)); } else { worst = worst.max(error); }
    }
    println!("{counted} lost {lost} worst {worst:e} mean count {}", total as f64 / counted as f64);
    assert!(lost == 0);
}
