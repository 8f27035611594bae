//! What a track costs the filter over multi-state constraints: `cargo bench -p benches --bench msckf`.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, Isometry3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::inertial::BodyPose;
use vislam::manifold::so3;
use vislam::msckf::{LinearizedTrack, Rows, Sight, landmark};
use vislam::reprojection::Pinhole;

const CAMERA: Pinhole = Pinhole { fx: 300.0, fy: 300.0, cx: 320.0, cy: 240.0 };

/// A camera that passes a landmark.
fn pass(poses: usize) -> Vec<Sight> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut number = |size: f64| random.random_range(-size..size);
    let landmark = Vector3::new(0.4, -0.3, 5.0);
    let sight = |k: usize| {
        let along = 2.0 * k as f64 / (poses - 1) as f64 - 1.0;
        let turn = Vector3::from_fn(|_, _| number(0.05));
        let position = Vector3::new(along, 0.2 * along * along, number(0.1));
        let pose = BodyPose { world_from_body: so3::exp(&turn), position };
        let seen = CAMERA.project(&pose.at_rest().pose().inverse(), &landmark);
        let pixel = seen.expect("it is in front") + Vector2::new(number(1.0), number(1.0));
        Sight { pose, linearized_at: pose, pixel }
    };
    (0..poses).map(sight).collect()
}

fn linearized(sights: &[Sight]) -> LinearizedTrack {
    let extrinsics = Isometry3::identity();
    let point = landmark(sights, &extrinsics, (&CAMERA, 1.0), 1e-3).expect("it has parallax");
    let mut track = LinearizedTrack::default();
    let outcome = track.linearize(sights, &point, &extrinsics, (&CAMERA, 1.0));
    outcome.map(|()| track).expect("it is in front")
}

/// The same by nalgebra: the QR decomposition of H_f, and its Qᵀ on all other columns.
fn by_dense_qr(rows: &DMatrix<f64>) -> DMatrix<f64> {
    let by_landmark = rows.columns(0, 3).into_owned();
    let mut others = rows.columns(3, rows.ncols() - 3).into_owned();
    by_landmark.qr().q_tr_mul(&mut others);
    others.rows(3, rows.nrows() - 3).into_owned()
}

fn project(bench: &mut Criterion) {
    for poses in [5, 11, 20, 30] {
        let sights = pass(poses);
        let track = linearized(&sights);
        let rows: Vec<f64> = track.rows().from(0).flatten().copied().collect();
        let rows = DMatrix::from_row_slice(2 * poses, track.rows().width(), &rows);
        bench.bench_function(&format!("project/givens/{poses}"), |bench| {
            let projected = |mut track: LinearizedTrack| {
                track.project(10.0).expect("its landmark is seen");
                track
            };
            bench.iter_batched(|| track.clone(), projected, BatchSize::SmallInput);
        });
        bench.bench_function(&format!("project/nalgebra_qr/{poses}"), |bench| {
            bench.iter(|| by_dense_qr(black_box(&rows)));
        });
        bench.bench_function(&format!("landmark/{poses}"), |bench| {
            let extrinsics = Isometry3::identity();
            bench.iter(|| landmark(black_box(&sights), &extrinsics, (&CAMERA, 1.0), 1e-3));
        });
        bench.bench_function(&format!("linearize/{poses}"), |bench| {
            let (extrinsics, point) = (Isometry3::identity(), Vector3::new(0.4, -0.3, 5.0));
            let mut track = LinearizedTrack::default();
            bench.iter(|| track.linearize(black_box(&sights), &point, &extrinsics, (&CAMERA, 1.0)));
        });
    }
}

fn compress(bench: &mut Criterion) {
    let (count, width) = (200, 73);
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut rows = Rows::new(width);
    (0..count).for_each(|_| {
        rows.add().iter_mut().for_each(|number| *number = random.random_range(-1.0..1.0))
    });
    let numbers: Vec<f64> = rows.from(0).flatten().copied().collect();
    let dense = DMatrix::from_row_slice(count, width, &numbers);
    bench.bench_function("compress/rows", |bench| {
        let compressed = |mut rows: Rows| {
            rows.compress();
            rows
        };
        bench.iter_batched(|| rows.clone(), compressed, BatchSize::SmallInput);
    });
    bench.bench_function("compress/nalgebra_qr", |bench| {
        bench.iter_batched(|| dense.clone(), |dense| dense.qr().unpack_r(), BatchSize::SmallInput);
    });
}

criterion_group!(benches, project, compress);
criterion_main!(benches);
