//! What rotations and poses cost: `cargo bench -p benches --bench manifold`.
//!
//! Every function is timed over vectors of two kinds: with the small angles that a gyroscope
//! turns by between two samples, and with angles of any size up to π.

use std::f64::consts::PI;
use std::hint::black_box;
use std::ops::Range;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::manifold::{se3, so3};

const SMALL: (&str, Range<f64>) = ("1e-3 to 0.1 rad", 1e-3..0.1);
const LARGE: (&str, Range<f64>) = ("up to pi", 0.0..PI);

fn rotations(criterion: &mut Criterion) {
    for (name, angles) in [SMALL, LARGE] {
        let vectors = rotation_vectors(angles);
        let rotations: Vec<_> = vectors.iter().map(so3::exp).collect();
        let mut group = criterion.benchmark_group(format!("so3, {name}"));
        time(&mut group, "exp", &vectors, so3::exp);
        time(&mut group, "exp_with_right_jacobian", &vectors, so3::exp_with_right_jacobian);
        time(&mut group, "log", &rotations, so3::log);
        time(&mut group, "right_jacobian", &vectors, so3::right_jacobian);
        time(&mut group, "right_jacobian_inverse", &vectors, so3::right_jacobian_inverse);
    }
}

fn poses(criterion: &mut Criterion) {
    for (name, angles) in [SMALL, LARGE] {
        let twists = twists(angles);
        let poses: Vec<_> = twists.iter().map(se3::exp).collect();
        let mut group = criterion.benchmark_group(format!("se3, {name}"));
        time(&mut group, "exp", &twists, se3::exp);
        time(&mut group, "log", &poses, se3::log);
        time(&mut group, "adjoint", &poses, se3::adjoint);
        time(&mut group, "right_jacobian", &twists, se3::right_jacobian);
        time(&mut group, "right_jacobian_inverse", &twists, se3::right_jacobian_inverse);
    }
}

type Group<'a> = criterion::BenchmarkGroup<'a, criterion::measurement::WallTime>;

/// Times single calls, each with the next of the inputs.
fn time<I, O>(group: &mut Group, name: &str, inputs: &[I], function: impl Fn(&I) -> O) {
    let mut next = inputs.iter().cycle();
    group.bench_function(name, |bencher| {
        bencher.iter(|| next.next().map(|input| function(black_box(input))));
    });
}

fn rotation_vectors(angles: Range<f64>) -> Vec<Vector3<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let vector = |_| {
        let axis = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)).normalize();
        random.random_range(angles.clone()) * axis
    };
    (0..1000).map(vector).collect()
}

fn twists(angles: Range<f64>) -> Vec<Vector6<f64>> {
    let twist = |phi: Vector3<f64>| Vector6::new(1.0, -2.0, 0.5, phi.x, phi.y, phi.z);
    rotation_vectors(angles).into_iter().map(twist).collect()
}

criterion_group! {
    name = manifold;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = rotations, poses
}
criterion_main!(manifold);
