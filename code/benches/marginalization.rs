//! Time of taking a keyframe out of a window together with fifty landmarks that it saw.
//!
//! `cargo bench -p benches --bench marginalization`
//!
//! Both forms, block by block, beside dense matrices of nalgebra: a QR decomposition of all rows, and
//! the inverse of the block that leaves.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::DMatrix;
use vislam::marginalization::{Information, Layout, SquareRoot, WindowSigmas, marginalize};

const LANDMARKS: usize = 50;

/// Eight keyframes, the first of which saw fifty landmarks that the next three saw too.
fn window() -> (SquareRoot<f64>, Vec<usize>) {
    let chain = Layout::chain(8, 0, 0);
    let layout = Layout { seen_by: vec![(0..4).collect(); LANDMARKS], ..chain };
    let problem = layout.problem(&WindowSigmas::default(), 1).expect("a layout");
    let window = SquareRoot::of_problem(&problem, problem.values()).expect("a window");
    (window, layout.slide(0))
}

/// The columns of what leaves, and those of what stays.
fn columns(window: &SquareRoot<f64>, gone: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let own = |name: &usize| window.blocks().columns_of(*name).expect("a block");
    let first: Vec<usize> = gone.iter().flat_map(own).collect();
    let then = (0..window.blocks().dimension()).filter(|column| !first.contains(column));
    (first.clone(), then.collect())
}

fn dense_qr(rows: &DMatrix<f64>, gone: usize) -> DMatrix<f64> {
    let triangle = rows.clone().qr().unpack_r();
    triangle.view_range(gone.., gone..).into_owned()
}

fn dense_inverse(matrix: &Information<f64>, gone: &[usize], stays: &[usize]) -> DMatrix<f64> {
    let rows = |columns: &[usize]| matrix.matrix().select_rows(columns);
    let (leaving, staying) = (rows(gone), rows(stays));
    let coupling = leaving.select_columns(stays);
    let inverse = leaving.select_columns(gone).try_inverse().expect("regular");
    staying.select_columns(stays) - coupling.tr_mul(&(inverse * &coupling))
}

fn marginalization(criterion: &mut Criterion) {
    let (window, gone) = window();
    let (first, then) = columns(&window, &gone);
    let information = window.information();
    let whole = window.root().select_columns(&[&first[..], &then].concat());
    let width = whole.ncols();
    let mut rows = whole.insert_column(width, 0.0);
    rows.set_column(width, window.offset());
    let (single, single_information) = (window.cast::<f32>(), window.cast::<f32>().information());
    let mut group = criterion.benchmark_group("a keyframe with fifty landmarks");
    group.bench_function("information form", |bencher| {
        bencher.iter(|| marginalize(black_box(&information), &gone));
    });
    group.bench_function("square-root form", |bencher| {
        bencher.iter(|| black_box(&window).marginalize(&gone));
    });
    group.bench_function("information form in single precision", |bencher| {
        bencher.iter(|| marginalize(black_box(&single_information), &gone));
    });
    group.bench_function("square-root form in single precision", |bencher| {
        bencher.iter(|| black_box(&single).marginalize(&gone));
    });
    group.bench_function("dense inverse", |bencher| {
        bencher.iter(|| dense_inverse(black_box(&information), &first, &then));
    });
    group.bench_function("dense QR", |bencher| {
        bencher.iter(|| dense_qr(black_box(&rows), first.len()));
    });
    group.finish();
}

criterion_group!(benches, marginalization);
criterion_main!(benches);
