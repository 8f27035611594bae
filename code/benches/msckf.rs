//! What a track costs the filter over multi-state constraints: `cargo bench -p benches --bench msckf`.

#[path = "../tests/msckf/passing.rs"]
mod passing;

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, Isometry3, Vector3};
use passing::{CAMERA, PARALLAX, SIGMA, pass};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::msckf::{LinearizedTrack, Rows, Sight, landmark};

fn linearized(sights: &[Sight], extrinsics: &Isometry3<f64>) -> LinearizedTrack {
    let camera = (&CAMERA, SIGMA);
    let point = landmark(sights, extrinsics, camera, PARALLAX).expect("it has parallax");
    let mut track = LinearizedTrack::default();
    let outcome = track.linearize(sights, &point, extrinsics, camera);
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
        let (sights, extrinsics) = pass(poses, 1);
        let (track, camera) = (linearized(&sights, &extrinsics), (&CAMERA, SIGMA));
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
            bench.iter(|| landmark(black_box(&sights), &extrinsics, camera, PARALLAX));
        });
        bench.bench_function(&format!("linearize/{poses}"), |bench| {
            let point = Vector3::new(0.4, -0.3, 5.0);
            let mut track = LinearizedTrack::default();
            bench.iter(|| track.linearize(black_box(&sights), &point, &extrinsics, camera));
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
