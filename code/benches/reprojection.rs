//! What a projection costs, with and without its Jacobians.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Isometry3, Vector2, Vector3};
use vislam::reprojection::{DistortedPinhole, Pinhole, RadialTangential, ReprojFactor};

fn projections(criterion: &mut Criterion) {
    let pinhole = Pinhole::new(458.654, 457.296, 367.215, 248.375).expect("a valid camera");
    let lens = RadialTangential::new(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0)
        .expect("a valid lens");
    let camera = DistortedPinhole { pinhole, lens };
    let pose = Isometry3::new(Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.1, -0.2, 0.3));
    let point = Vector3::new(0.2, -0.1, 5.0);
    let factor = ReprojFactor::new(0, 0, Vector2::new(380.0, 240.0), 1.0).expect("an observation");

    let mut bench = |name: &str, run: &dyn Fn(&Isometry3<f64>, &Vector3<f64>)| {
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| run(black_box(&pose), black_box(&point)));
        });
    };
    bench("project", &|pose, point| {
        black_box(pinhole.project(pose, point));
    });
    bench("project_with_jacobians", &|pose, point| {
        black_box(pinhole.project_with_jacobians(pose, point));
    });
    bench("project_with_jacobians and linearize", &|pose, point| {
        let projection = pinhole.project_with_jacobians(pose, point);
        black_box(projection.map(|projection| factor.linearize(&projection)));
    });
    bench("project_with_jacobians, distorted", &|pose, point| {
        black_box(camera.project_with_jacobians(pose, point));
    });

    let corner = Vector2::new(-0.8, -0.54);
    criterion.bench_function("undistort", |bencher| {
        bencher.iter(|| lens.undistort(black_box(&corner)));
    });
}

criterion_group!(benches, projections);
criterion_main!(benches);
